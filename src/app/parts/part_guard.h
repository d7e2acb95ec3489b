#pragma once

#include "app/parts/fault_log.h"
#include "app/parts/part.h"
#include "drivers/common/back_off.h"

#include "core/clock.h"

#include <functional>
#include <string>
#include <vector>

namespace fantascope::app {

// Keeps a failure of one part from the others. An exception in a part's work is a fault of that
// part: it is reported, and the other parts go on. The part is tried again with a back-off from
// kSoonest to kLatest, or to kLatestInput if a person may be waiting for it. A part of the lighting
// rank is tried again at its next tick, because fixtures and relays must not wait.
// A broken invariant (FANTASCOPE_CHECK) still ends the program.
// Thread: that of the part.
class PartGuard {
public:
    static constexpr Time kSoonest = std::chrono::milliseconds(50), kLatestInput = std::chrono::seconds(1),
                          kLatest = std::chrono::seconds(10);

    // `faults` outlives the guard.
    PartGuard(std::string part, Rank rank, FaultLog& faults);

    // Does the work for a moment, unless the back-off is still on. Returns whether the work
    // succeeded.
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
std::vector<Part> guarded(std::vector<Part> parts, FaultLog& faults);

}  // namespace fantascope::app
