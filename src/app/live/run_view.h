#pragma once

#include "app/live/playback_replica.h"
#include "app/live/run_console.h"

#include "show/event.h"
#include "show/input_log.h"
#include "show/show.h"
#include "show/show_clock.h"

#include "core/clock.h"

#include <optional>
#include <string>

namespace fantascope::app {

// What the terminal shows of the show: what is on, what comes and when, and what has happened since
// it looked last.
// Thread: one at a time.
class RunView {
public:
    // All outlive it, but for the clock. `length`: of the run, in run time; nothing: until somebody
    // ends it.
    RunView(const show::Show& show, const show::InputLog& inputs, const show::EventLog& events, const show::ShowClock& showClock,
            std::optional<Time> length)
        : show_(show), showClock_(showClock), length_(length), replica_(inputs), events_(events.reader()) {}

    // `nextGo`: run time of the next GO that no person presses; Time::max(): none is to come.
    RunStatus at(Time moment, Time nextGo);
    // Whether something has happened that at() has not told yet.
    bool hasNews();

private:
    const show::Show& show_;
    const show::ShowClock showClock_;
    const std::optional<Time> length_;
    PlaybackReplica replica_;
    show::ShowState state_;
    show::EventLog::Reader events_;
    std::string news_;
};

}  // namespace fantascope::app
