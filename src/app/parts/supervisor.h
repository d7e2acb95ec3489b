#pragma once

#include "app/base/interrupt.h"
#include "app/site/relay_guard.h"

#include "core/clock.h"

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace fantascope::app {

// Ends a run on request, whatever hangs. On a thread of its own it sees the request and has the
// relays made safe at once, without waiting for a display, a recording or a terminal. The render
// thread then ends the run in steps. A step that exceeds its timeout hangs (a stopped X server, a
// graphics card, a disk). Then the supervisor sets the fixtures to their end levels at once, closes
// fixtures and relays, writes the report, says what hung, and exits with status 1. It also starts
// another relay guard if the guard has died.
//
// Before attend(), if a step of the preparation exceeds its timeout, it says so on the terminal.
//
// A broken output pipe (`run ... | head -1`) is a request to end, too.
class Supervisor {
public:
    static constexpr Time kPatience = std::chrono::seconds(5);  // the default timeout of a step
    static constexpr Time kSafeWithin = std::chrono::seconds(2);

    // What the supervisor calls of a run, from when the run may switch relays.
    struct Run {
        std::function<void()> end;    // relays go to their safe states, fixtures to their end levels; never waits
        std::function<void()> hurry;  // fixtures skip the rest of their fade; never waits
        std::function<bool()> ended;  // whether both are there
        std::function<void()> close;  // closes lines and banks; may wait for them, but for nothing else
        std::function<void(const std::string& why)> tell;  // writes the report and the last message if the render thread hangs
        std::function<void(const Result<void>& another)> tellGuardDied;  // `another`: whether there is another guard
    };

    // `guard` may be null; both outlive the supervisor.
    Supervisor(const Interrupt& interrupt, RelayGuard* guard);
    ~Supervisor();  // the run has ended in order
    Supervisor(const Supervisor&) = delete;
    Supervisor& operator=(const Supervisor&) = delete;

    void attend(Run run);
    // Ends attend(): from now on none of the run's functions is called. Call it when fixtures and
    // relays are closed and the report is written.
    void release();
    // Names the render thread's next step, with its timeout, which counts once the run is to end.
    void step(std::string doing, Time patience = kPatience);
    // The step makes progress: its timeout begins again. From any thread.
    void advance();

    // From any thread; neither waits.
    void requestEnd() { requested_ = true; }
    bool ending() const { return requested_ || interrupt_.requested(); }

private:
    void live(const std::stop_token& stop);
    void look(const std::stop_token& stop);
    bool outputIsRead();
    void keepGuard(Time now);
    void endRun();                   // with the mutex held
    void tellOfSlowSetUp(Time now);  // with the mutex held
    // Why the supervisor no longer waits for the render thread; nothing: it does. With the mutex
    // held.
    std::optional<std::string> hung(Time now) const;
    [[noreturn]] void leave(const std::string& why);

    const Interrupt& interrupt_;
    RelayGuard* const guard_;
    SteadyClock clock_;
    std::atomic<bool> requested_ = false;
    Time nextGuard_{}, guardPause_{};
    bool failureTold_ = false;
    std::mutex mutex_;  // of:
    std::optional<Run> run_;
    bool isSettingUp_ = true;    // the run is in preparation, and no message about a slow step was given yet
    std::optional<Time> began_;  // when the end began
    bool endIsTold_ = false;     // to the run
    int signals_ = 0;            // counted so far
    bool pressedAgain_ = false;  // the operator does not want to wait
    std::string doing_;
    Time since_{}, patience_ = kPatience;
    std::jthread thread_;
};

}  // namespace fantascope::app
