#pragma once

#include "show/cue_list.h"
#include "show/show.h"
#include "show/site/site.h"

#include "core/result.h"

#include <memory>

namespace fantascope::show {

// A show and a site that were read together. A revision never changes. A player holds the current
// one, and an input delivers a newer one (InputLog::add). Two revisions may be in use at once.
// Thread: any.
struct Revision {
    Show show;
    Site site;
    CueList cues;  // of `show` on `site`

    // Error: as Show::bind.
    static Result<std::shared_ptr<const Revision>> of(Show show, Site site);
    // The cue list of a revision. The pointer keeps the whole revision alive.
    static std::shared_ptr<const CueList> cuesOf(const std::shared_ptr<const Revision>& revision) {
        return {revision, &revision->cues};
    }
};

}  // namespace fantascope::show
