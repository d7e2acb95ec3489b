#pragma once

#include "app/live/fault_log.h"
#include "app/live/lighting.h"
#include "app/live/part.h"
#include "app/live/run_report.h"
#include "app/site/devices.h"
#include "app/site/relay_guard.h"

#include "show/site/site.h"

#include "core/clock.h"

#include <functional>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

namespace fantascope::app {

// Lamps and relays from their parts' start to their closing, which also happens where the render
// thread hangs.
// Thread: close() and whileOpen() from any, the rest on the run's own.
class RunLights {
public:
    // All outlive it; `guard` may be null.
    RunLights(const show::Site& site, Devices& devices, Lighting& lighting, FaultLog& faults, Clock& clock, RelayGuard* guard)
        : site_(site), devices_(devices), lighting_(lighting), faults_(faults), clock_(clock), guard_(guard) {}

    // The lights' parts, on threads that end with close().
    void start(std::vector<Part> parts) { threads_.emplace(clock_, std::move(parts)); }
    // Waits until lamps and relays are where they are to be at the end, for as long as that may
    // take.
    void await();
    // Ends what works on lamps and relays and closes both; `terminal` is called in between. Where
    // all relays are safe the guard may go. Only the first call counts.
    void close(const std::function<void()>& terminal);
    // Calls it unless they are closed; they stay open meanwhile.
    void whileOpen(const std::function<void()>& work);

    // Once they are closed.
    const std::vector<UnsafeBank>& unsafe() const { return unsafe_; }
    const std::vector<UnendedLine>& unended() const { return unended_; }
    // What is not as it is to be at the end becomes faults of that moment.
    void raiseFaults(Time moment);

private:
    const show::Site& site_;
    Devices& devices_;
    Lighting& lighting_;
    FaultLog& faults_;
    Clock& clock_;
    RelayGuard* guard_;
    std::mutex closing_;  // of:
    bool closed_ = false;
    std::vector<UnsafeBank> unsafe_;
    std::vector<UnendedLine> unended_;
    std::optional<PartThreads> threads_;  // last, so that none works on what has gone
};

}  // namespace fantascope::app
