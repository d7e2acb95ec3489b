#pragma once

#include "show/play/event.h"
#include "show/play/input_log.h"
#include "show/play/playback_replica.h"
#include "show/play/show_clock.h"
#include "show/played_show.h"
#include "show/schedule/nights.h"

#include "core/clock.h"
#include "core/wall_clock.h"

#include <optional>
#include <string>

namespace fantascope::app {

// Calls the cues of a show's schedule: it asks for each cue when the machine's clock says so.
//
// - Whoever comes late joins the show where it would be: a machine that starts in the middle of a
//   night, or whose clock was wrong and is set. The cue was to be entered a while ago, and is
//   entered so (Input::ago).
// - A clock that is set back by a few minutes calls no cue again.
// - What people do between two moments of the schedule stays, until the next one.
// - If the show is revised, the cue of the same name that is due counts as called.
// - In a panic no cue can be entered, so the schedule waits for its end.
//
// Thread: one at a time.
class ShowCaller {
public:
    // All arguments but `showClock` outlive this. It does nothing where the show has no schedule.
    ShowCaller(const show::PlayedShow& show, show::InputLog& inputs, show::EventLog& events, const WallClock& wall,
               const show::ShowClock& showClock);

    // Calls what is due as the run starts. `followed`: until then (UTC) an earlier run has followed
    // the schedule, or somebody wants another cue first; nothing: the show begins.
    void begin(std::optional<Time> followed);
    static constexpr double kRate = 4;  // Hz
    void tick(Time moment);
    // nextDayOf() the present moment; empty: there is no schedule. Thread: any.
    std::string nextDay() const;

private:
    void follow(const show::Revision& revision, Time utc);
    bool isCalled(const show::Nights::Moment& due, Time utc) const;
    void tellOfClock(Time utc, Time moment);

    const show::PlayedShow& show_;
    const show::Revision* revision_;  // that the cues below are of
    show::InputLog& inputs_;
    show::EventLog& events_;
    const WallClock& wall_;
    const show::ShowClock showClock_;
    show::PlaybackReplica replica_;
    show::ShowState state_;
    std::optional<show::Nights::Stretch> stretch_;  // the present one
    std::optional<show::Nights::Moment> called_;
    std::optional<Time> began_;  // UTC of show time 0, by the wall clock at the last tick
};

}  // namespace fantascope::app
