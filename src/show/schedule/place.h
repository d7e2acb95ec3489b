#pragma once

#include "show/schedule/night_time.h"

#include "core/config/config.h"
#include "core/result.h"

#include <optional>
#include <vector>

namespace fantascope::show {

// The hours in which a town allows light, on some nights of the week.
struct AllowedHours {
    std::optional<NightTime> from, until;  // nothing: from noon, until noon
    Weekdays on;
};

// Where a site is. See docs/site-format.md.
struct Place {
    Whereabouts whereabouts;
    std::vector<AllowedHours> hours;  // the first ones of a night count; empty: light is always allowed
};

// Error: file, line, column, key, advice, for all faults.
Result<Place> readPlace(const ConfigNode& node);

}  // namespace fantascope::show
