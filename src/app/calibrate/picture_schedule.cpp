#include "app/calibrate/picture_schedule.h"

#include "core/check.h"

#include <algorithm>

namespace fantascope::app {

Time PictureSchedule::dwell(int frames) const { return before() + after() + frames * period_ + (delay_.latest - delay_.soonest); }

void PictureSchedule::show(std::int64_t picture, Time from) {
    FANTASCOPE_CHECK(shown_.empty() || from >= shown_.back().from, "pictures follow each other");
    shown_.push_back({picture, from});
}

std::optional<std::int64_t> PictureSchedule::pictureOf(Time exposed) const {
    const auto next = std::upper_bound(shown_.begin(), shown_.end(), exposed - before() - delay_.latest,
                                       [](Time moment, const Shown& shown) { return moment < shown.from; });
    if (next == shown_.begin()) return std::nullopt;
    if (next != shown_.end() && next->from < exposed + after() - delay_.soonest) return std::nullopt;
    return std::prev(next)->picture;
}

}  // namespace fantascope::app
