#include "show/revision.h"

#include <fmt/format.h>

#include <utility>

namespace fantascope::show {

Result<std::shared_ptr<const Revision>> Revision::of(Show show, Site site, const PlayLengths* lengths) {
    CueList cues = TRY(show.bind(site, lengths));
    std::optional<Nights> nights = TRY(nightsOf(show, site));
    return std::make_shared<const Revision>(Revision{std::move(show), std::move(site), std::move(cues), std::move(nights)});
}

Result<std::optional<Nights>> nightsOf(const Show& show, const Site& site) {
    if (!show.schedule) return std::optional<Nights>();
    if (site.place) return std::optional(Nights(*show.schedule, *site.place));
    return show.schedule->at.error(fmt::format(
        "a schedule needs to know where the show is: add 'place: {{latitude: .., longitude: .., time_zone: ..}}' to {}",
        site.file.string()));
}

}  // namespace fantascope::show
