#pragma once

#include "show/cue_list.h"
#include "show/show.h"
#include "show/site/site.h"

#include "core/result.h"

#include <memory>

namespace fantascope::show {

// A show and a site as they were read together at one time. It never changes: whoever plays holds
// the one that is in effect, and a newer one is delivered as an input (InputLog::add). Two may be
// in use at once. Thread: any.
struct Revision {
    Show show;
    Site site;
    CueList cues;  // of `show` on `site`

    // Error: as Show::bind.
    static Result<std::shared_ptr<const Revision>> of(Show show, Site site);
    // The cue list, which keeps all of the revision alive.
    static std::shared_ptr<const CueList> cuesOf(const std::shared_ptr<const Revision>& revision) {
        return {revision, &revision->cues};
    }
};

}  // namespace fantascope::show
