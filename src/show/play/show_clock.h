#pragma once

#include "core/clock.h"

#include <optional>
#include <vector>

namespace fantascope::show {

// Converts the machine's clock to show time. Show time counts from the show's epoch, run time from
// the start of this run: a show that is resumed at hour three has show time three hours when its
// run time is 0. Lateness, patience and progress count in run time; cues, pictures and inputs count
// in show time.
//
// A show may pause, jump (seek) or run faster or slower (setRate). Each change holds from a moment
// on and leaves the past as it was, so that past moments can still be asked for. Changes come in
// the order of their moments.
//
// Value type: every thread has its own copy. Moments are on the machine's clock.
class ShowClock {
public:
    // At `runStart` the show is at `showAtStart`, and runs at rate 1.
    explicit ShowClock(Time runStart = Time{}, Time showAtStart = Time{});

    Time runStart() const { return runStart_; }
    Time runTime(Time moment) const { return moment - runStart_; }
    // The show time of any moment. Moments before the run's start count as if the run had begun
    // earlier. Exact at rate 1, else to a nanosecond.
    Time showTime(Time moment) const;
    // The first moment, from `since` on, at which the show is at `showTime`; nothing if it never
    // will be, unless the clock changes again.
    std::optional<Time> momentOf(Time showTime, Time since) const;
    // The rate of show time; 0 while the show is paused.
    double rateAt(Time moment) const;

    void pause(Time moment);
    void resume(Time moment);  // at the rate before the pause
    void seek(Time moment, Time showTime);
    // rate > 0. A rate set during a pause holds from resume() on.
    void setRate(Time moment, double rate);

private:
    // From `moment` on, the show runs from `showTime` at `rate`.
    struct Stretch {
        Time moment, showTime;
        double rate;
        Time showTimeAt(Time at) const;
    };
    const Stretch& at(Time moment) const;
    void change(Time moment, Time showTime, double rate);

    Time runStart_;
    double rate_ = 1;                 // while the show is not paused
    std::vector<Stretch> stretches_;  // by moment
};

}  // namespace fantascope::show
