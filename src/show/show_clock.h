#pragma once

#include "core/clock.h"

#include <optional>
#include <vector>

namespace fantascope::show {

// Show time from the machine's clock. Show time counts from the show's epoch, run time from the
// start of this run: a show that is resumed at hour three has show time three hours when its run
// time is 0. Lateness, patience and progress count in run time; cues, pictures and inputs in show
// time.
//
// A show may stand still (pause), jump (seek) or go faster or slower (setRate). Each change holds
// from a moment on and alters nothing before, so that what was seen then can still be asked for.
// Changes come in the order of their moments.
//
// Value type: every thread has its own copy. Moments are on the machine's clock.
class ShowClock {
public:
    // At `runStart` the show stands at `showAtStart`, and goes on at rate 1.
    explicit ShowClock(Time runStart = Time{}, Time showAtStart = Time{});

    Time runStart() const { return runStart_; }
    Time runTime(Time moment) const { return moment - runStart_; }
    // Of any moment; before the run's start as if it had begun earlier. At rate 1 exact, else to a
    // nanosecond.
    Time showTime(Time moment) const;
    // The first moment, from `since` on, at which the show stands at `showTime`; nothing: it never
    // will, as the clock goes now.
    std::optional<Time> momentOf(Time showTime, Time since) const;
    // 0 while the show stands still.
    double rateAt(Time moment) const;

    void pause(Time moment);
    void resume(Time moment);  // at the rate of before the pause
    void seek(Time moment, Time showTime);
    // rate > 0. While the show stands still it holds from resume() on.
    void setRate(Time moment, double rate);

private:
    // From `moment` on the show goes from `showTime` at `rate`.
    struct Stretch {
        Time moment, showTime;
        double rate;
        Time showTimeAt(Time at) const;
    };
    const Stretch& at(Time moment) const;
    void change(Time moment, Time showTime, double rate);

    Time runStart_;
    double rate_ = 1;                 // while the show goes
    std::vector<Stretch> stretches_;  // by moment
};

}  // namespace fantascope::show
