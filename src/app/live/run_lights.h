#pragma once

#include "app/live/lighting.h"
#include "app/live/run_report.h"
#include "app/parts/fault_log.h"
#include "app/parts/part.h"
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

// The life of fixtures and relays in a run, from the start of their parts to their closing. They
// are closed even if the render thread hangs.
// Thread: close() and whileOpen() from any thread, the rest from the run's thread.
class RunLights {
public:
    // All arguments by reference outlive this. `guard` may be null.
    RunLights(const show::Site& site, Devices& devices, Lighting& lighting, FaultLog& faults, Clock& clock, RelayGuard* guard)
        : site_(site), devices_(devices), lighting_(lighting), faults_(faults), clock_(clock), guard_(guard) {}

    // Starts the lights' parts on threads that end with close().
    void start(std::vector<Part> parts) { threads_.emplace(clock_, std::move(parts)); }
    // Waits until the fixtures have their end levels and the relays their safe states, or until the
    // time allowed for this is over.
    void await();
    // Ends the parts and closes lines and banks. `terminal` is called in between. If all relays are
    // safe, the guard is dismissed. Only the first call has an effect.
    void close(const std::function<void()>& terminal);
    // Calls `work` unless the devices are closed. They stay open during the call.
    void whileOpen(const std::function<void()>& work);

    // The banks and lines that did not end as they should. Call these after close().
    const std::vector<UnsafeBank>& unsafe() const { return unsafe_; }
    const std::vector<UnendedLine>& unended() const { return unended_; }
    // Raises faults at `moment` for these banks and lines.
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
    std::optional<PartThreads> threads_;  // last, so that the threads end before the other members are destroyed
};

}  // namespace fantascope::app
