#pragma once

#include "app/live/run_console.h"

#include "show/play/event.h"
#include "show/play/input_log.h"
#include "show/play/playback_replica.h"
#include "show/play/show_clock.h"
#include "show/played_show.h"

#include "core/clock.h"

#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// What the terminal shows of a run: the current cue, the next cue and when it comes, and the news
// since the last status.
// Thread: one at a time.
class RunView {
public:
    // All arguments by reference outlive this, except `showClock`. `length`: of the run, in run
    // time; none: the run goes on until somebody ends it.
    RunView(const show::PlayedShow& show, const show::InputLog& inputs, const show::EventLog& events,
            const show::ShowClock& showClock, std::optional<Time> length)
        : show_(show), showClock_(showClock), length_(length), replica_(inputs), events_(events.reader()) {}

    // The status at `moment`. `nextGo`: run time of the schedule's next GO; Time::max() if there is
    // none. `list`: that the keys for cues go to, as Input::list.
    RunStatus at(Time moment, Time nextGo, int list = 0);
    // Whether there is news that at() has not reported yet.
    bool hasNews();

private:
    const show::PlayedShow& show_;
    const show::ShowClock showClock_;
    const std::optional<Time> length_;
    show::PlaybackReplica replica_;
    show::ShowState state_;
    show::EventLog::Reader events_;
    std::string news_;
};

// How the show is, in lines: which outputs are dark, and why, and what is not well. `faults`: those
// that last.
std::string howItIs(const show::ShowState& state, const show::Revision& revision, const std::vector<FaultReport>& faults);
// The devices and parts that have one of these faults: "left, dmx".
std::string namesOf(const std::vector<FaultReport>& faults);

}  // namespace fantascope::app
