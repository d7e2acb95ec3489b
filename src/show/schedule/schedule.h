#pragma once

#include "show/schedule/night_time.h"

#include "core/clock.h"
#include "core/config/config.h"
#include "core/result.h"

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::show {

// What a show plays in which nights, as its author wrote it. See docs/show-format.md.
struct Schedule {
    // In a night a cue is entered at `from`. At `until` it gets dark, unless another item has begun
    // meanwhile, or begins then.
    struct Item {
        std::size_t cue = 0;  // index into Show::cues
        NightTime from;
        std::optional<NightTime> until;  // nothing: until the night ends
        Weekdays on = Weekdays().set();
    };
    FilePlace at;                         // in the show file
    std::optional<Date> first, last;      // night; nothing: no first, no last one
    std::vector<Date> dark;               // nights without a show
    Time fade = std::chrono::seconds(5);  // to the dark
    std::vector<Item> items;
};

// `cues`: the names of the show's. Error: file, line, column, key, advice, for all faults.
Result<Schedule> readSchedule(const ConfigNode& node, const std::vector<std::string>& cues);

}  // namespace fantascope::show
