#pragma once

#include "app/live/fault_log.h"
#include "app/live/part.h"
#include "drivers/common/back_off.h"

#include "core/clock.h"

#include <functional>
#include <string>

namespace fantascope::app {

// Lets the work of one part fail alone: an exception out of it is a fault of that part, which is
// told and stands in the report, and the other parts play on. The part is tried again with a
// back-off from kSoonest to kLatest, or to kLatestInput where a person may be waiting for it. A
// part of the lighting rank is tried again at its next tick, because lamps and relays must not
// wait.
// A broken invariant (FANTASCOPE_CHECK) still ends the program.
// Thread: that of the part.
class PartGuard {
public:
    static constexpr Time kSoonest = std::chrono::milliseconds(50), kLatestInput = std::chrono::seconds(1),
                          kLatest = std::chrono::seconds(10);

    // `faults` outlives it.
    PartGuard(std::string part, Rank rank, FaultLog& faults);

    // Does the work for a moment, unless it failed a short time ago. Whether it was done.
    bool run(Time moment, const std::function<void(Time)>& work);

private:
    void tellFailure(Time moment, const char* why) noexcept;
    void tellRecovery(Time moment) noexcept;

    const std::string part_;
    const Rank rank_;
    FaultLog& faults_;
    drivers::BackOff backOff_;
    Time nextTry_ = Time::min();
    bool failed_ = false;  // the last time
};

// The part with a guard around its work.
Part guarded(Part part, FaultLog& faults);

}  // namespace fantascope::app
