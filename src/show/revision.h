#pragma once

#include "show/cue_list.h"
#include "show/schedule/nights.h"
#include "show/show.h"
#include "show/site/site.h"

#include "core/result.h"

#include <memory>
#include <optional>

namespace fantascope::show {

// A show and a site that were read together. A revision never changes. A player holds the current
// one, and an input delivers a newer one (InputLog::add). Two revisions may be in use at once.
// Thread: any.
struct Revision {
    Show show;
    Site site;
    CueList cues;                  // of `show` on `site`
    std::optional<Nights> nights;  // of a show with a schedule

    // Error: as Show::bind; or the show has a schedule, but the site no place.
    // `lengths`: as of Show::bind.
    static Result<std::shared_ptr<const Revision>> of(Show show, Site site, const PlayLengths* lengths = nullptr);
    // The cue list of a revision. The pointer keeps the whole revision alive.
    static std::shared_ptr<const CueList> cuesOf(const std::shared_ptr<const Revision>& revision) {
        return {revision, &revision->cues};
    }
};

// What a show's schedule does at a site; nothing: the show has none. Error: place in the show file;
// the site has no place.
Result<std::optional<Nights>> nightsOf(const Show& show, const Site& site);

}  // namespace fantascope::show
