#pragma once
// How the parts of a running show share time: each part is a thing to do at its next moment. In
// real time every part has a thread of its own; on a stepped clock one thread runs all of them in
// the order of their moments, and the same code gives the same result every time.

#include "core/clock.h"

#include <functional>
#include <string>
#include <thread>
#include <vector>

namespace fantascope::app {

// Who goes first in real time: what the audience sees, then its light, the operator's hand, and
// last what only looks on.
enum class Rank { Render, Lighting, Input, Watch };

// Gives the calling thread, and those that it makes from now on, a rank. Where the system allows
// it, rendering preempts everything else (SCHED_RR); without that privilege only those who look on
// give way, and nothing is refused.
void setThreadRank(Rank rank);

// One part of a running show that works at moments of its own: lighting ticks, camera frames,
// button polls.
struct Part {
    std::string name;
    double rate = 0;                 // Hz
    Time phase{};                    // of the first moment
    std::function<void(Time)> work;  // handed the moment that it is for; may be called late, never early
    Rank rank = Rank::Input;         // of its thread in real time
};

// The parts in real time: a thread each. A part that is late does the work for the newest moment
// and leaves the missed ones out.
class PartThreads {
public:
    PartThreads(Clock& clock, std::vector<Part> parts);
    ~PartThreads();  // returns when the work that is under way is done
    // Ends the parts of all other ranks; returns when the work that they have under way is done.
    void endAllBut(Rank rank);

private:
    struct Running {
        Rank rank;
        std::jthread thread;
    };
    std::vector<Running> threads_;
};

// A clock for a rehearsal as fast as possible: whoever sleeps on it lets the parts do what is due
// until then, at their exact moments and in the order of the parts where moments meet. Thread:
// thread-bound, but for now().
class SteppedClock final : public Clock {
public:
    Time now() const override { return manual_.now(); }
    void sleepUntil(Time time) override;
    void setParts(std::vector<Part> parts);
    void endAllBut(Rank rank);  // as PartThreads'

private:
    struct Scheduled {
        Part part;
        std::int64_t next = 0;
        Time due() const { return part.phase + tickTime(next, part.rate); }
    };
    ManualClock manual_;
    std::vector<Scheduled> parts_;
    bool stepping_ = false;
};

}  // namespace fantascope::app
