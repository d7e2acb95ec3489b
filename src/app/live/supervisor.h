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

// Ends a run that is to end, whatever hangs: on a thread of its own it sees the request and has the
// relays made safe at once, without waiting for a display, a recording or a terminal. The render
// thread then takes the run apart in steps. A step that takes longer than it may hangs (an X server
// that was stopped, a graphics card, a disk): the supervisor has the lamps go to their end levels
// at once, closes lamps and relays, writes the report, says what hung, and leaves with exit status
// 1. It also starts another relay guard where that has died.
//
// Before attend() it says on the terminal what a set-up waits for that takes longer than it may.
//
// Whoever reads this program's output through a pipe and goes (`run ... | head -1`) asks for the
// end too.
class Supervisor {
public:
    static constexpr Time kPatience = std::chrono::seconds(5);  // of a step that has no other
    static constexpr Time kSafeWithin = std::chrono::seconds(2);

    // What a run has from when it may switch relays.
    struct Run {
        std::function<void()> end;    // relays to their safe states, lamps to their end levels; never waits
        std::function<void()> hurry;  // lamps to their end levels without the rest of their fade; never waits
        std::function<bool()> ended;  // whether both are there
        std::function<void()> close;  // lamps and relays; may wait for their lines, for nothing else
        std::function<void(const std::string& why)> tell;  // report and last words, where the render thread does not come back
        std::function<void(const Result<void>& another)> tellGuardDied;  // and whether there is another one
    };

    // `guard` may be null; both outlive it.
    Supervisor(const Interrupt& interrupt, RelayGuard* guard);
    ~Supervisor();  // the run has ended in order
    Supervisor(const Supervisor&) = delete;
    Supervisor& operator=(const Supervisor&) = delete;

    void attend(Run run);
    // Lamps and relays are closed and the report is written: of what attend() was given nothing is
    // called any more.
    void release();
    // What the render thread does from now on, and how long it may go on with it once the run is to
    // end.
    void step(std::string doing, Time patience = kPatience);
    // The step gets on: it has its patience anew. From any thread.
    void advance();

    // From any thread; neither waits.
    void requestEnd() { requested_ = true; }
    bool ending() const { return requested_ || interrupt_.requested(); }

private:
    void live(const std::stop_token& stop);
    void look(const std::stop_token& stop);
    bool outputIsRead();
    void keepGuard(Time now);
    void begin(Time now);            // of the end; with the mutex held
    void tellOfSlowSetUp(Time now);  // with the mutex held
    // Why nobody waits for the render thread any more; with the mutex held.
    std::optional<std::string> hung(Time now) const;
    [[noreturn]] void leave(const std::string& why);

    const Interrupt& interrupt_;
    RelayGuard* const guard_;
    SteadyClock clock_;
    std::atomic<bool> requested_ = false;
    Time nextGuard_{}, guardPause_{};
    std::mutex mutex_;  // of:
    std::optional<Run> run_;
    bool isSettingUp_ = true;    // and nobody was told yet that it takes long
    std::optional<Time> began_;  // the end
    int signals_ = 0;            // counted so far
    bool pressedAgain_ = false;  // the operator will not wait
    std::string doing_;
    Time since_{}, patience_ = kPatience;
    std::jthread thread_;
};

}  // namespace fantascope::app
