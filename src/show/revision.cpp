#include "show/revision.h"

#include <utility>

namespace fantascope::show {

Result<std::shared_ptr<const Revision>> Revision::of(Show show, Site site) {
    CueList cues = TRY(show.bind(site));
    return std::make_shared<const Revision>(Revision{std::move(show), std::move(site), std::move(cues)});
}

}  // namespace fantascope::show
