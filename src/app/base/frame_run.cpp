#include "app/base/frame_run.h"

#include "app/base/attendance.h"
#include "app/base/progress.h"

#include "core/clock.h"

#include <fmt/format.h>

#include <iostream>

namespace fantascope::app {

Result<std::int64_t> makeFrames(const std::string& label, std::int64_t count,
                                const std::function<Result<void>(std::int64_t number)>& make) {
    SteadyClock clock;
    Attendance attendance(clock);
    Progress progress(label, clock, std::cerr, standardErrorIsTerminal());
    std::int64_t made = 0;
    const auto tell = [&](const char* how) {
        progress.update(static_cast<double>(made) / static_cast<double>(count),
                        fmt::format("frame {} of {}{}", made, count, how));
    };
    for (; made < count && attendance.goesOn([&] { tell("  paused, space goes on"); }); ++made) {
        tell("");
        TRY(make(made));
    }
    return made;
}

std::string outcomeOf(std::int64_t made, std::int64_t count, double frameRate) {
    const double length = seconds(tickTime(made, frameRate));
    if (made == count) return fmt::format("{} frames, {:.2f} s", made, length);
    if (made == 0) return "interrupted before the first frame, nothing is written";
    return fmt::format("interrupted; the first {} of {} frames are whole and play, {:.2f} s", made, count, length);
}

}  // namespace fantascope::app
