#include "app/frame_run.h"

#include "app/interrupt.h"
#include "app/progress.h"
#include "app/terminal_keys.h"

#include "core/clock.h"

#include <fmt/format.h>

#include <iostream>

namespace fantascope::app {

Result<std::int64_t> makeFrames(const std::string& label, std::int64_t count,
                                const std::function<Result<void>(std::int64_t number)>& make) {
    constexpr Time kLook = std::chrono::milliseconds(50);  // how long a paused run looks away
    constexpr char kEscape = '\x1b';
    const Interrupt interrupt;
    SteadyClock clock;
    TerminalKeys keys;
    Progress progress(label, clock, std::cerr, standardErrorIsTerminal());
    bool paused = false, enough = false;
    std::int64_t made = 0;
    while (made < count) {
        while (const auto key = keys.poll()) {
            if (*key == ' ') paused = !paused;
            enough = enough || (*key == kEscape && !keys.poll());  // an arrow key begins with it too
        }
        if (enough || interrupt.requested()) break;
        progress.update(static_cast<double>(made) / static_cast<double>(count),
                        fmt::format("frame {} of {}{}", made, count, paused ? "  paused, space goes on" : ""));
        if (paused)
            clock.sleepUntil(clock.now() + kLook);
        else
            TRY(make(made++));
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
