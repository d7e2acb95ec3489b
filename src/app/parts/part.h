#pragma once
// How the parts of a running show share time. Each part has work to do at its own moments. In real
// time every part has a thread of its own. On a stepped clock one thread runs all parts in the
// order of their moments, so the same code gives the same result every time.

#include "core/clock.h"

#include <functional>
#include <string>
#include <thread>
#include <vector>

namespace fantascope::app {

// The priority of a thread in real time, highest first: pictures, fixtures and relays, the
// operator's input, and last the parts that only observe.
enum class Rank { Render, Lighting, Input, Watch };

// Gives a rank to the calling thread and to the threads that it makes from now on. If the system
// allows it, rendering preempts everything else (SCHED_RR). Without that privilege only the
// observing parts give way, and that is no error.
void setThreadRank(Rank rank);

// One part of a running show that works at moments of its own: lighting ticks, camera frames,
// button polls.
struct Part {
    std::string name;
    double rate = 0;                 // Hz
    Time phase{};                    // of the first moment
    std::function<void(Time)> work;  // called with its moment; perhaps late, never early
    Rank rank = Rank::Input;         // of its thread in real time
};

// The parts in real time: a thread each. A late part does the work of the newest moment and skips
// the missed ones.
class PartThreads {
public:
    PartThreads(Clock& clock, std::vector<Part> parts);
    ~PartThreads();  // returns when the work in progress is done
    // Ends the parts of all other ranks; returns when their work in progress is done.
    void endAllBut(Rank rank);

private:
    struct Running {
        Rank rank;
        std::jthread thread;
    };
    std::vector<Running> threads_;
};

// A clock for a rehearsal as fast as possible. sleepUntil() runs the work of the parts that is due
// until then, at its exact moments; at equal moments the order of the parts counts. Thread:
// thread-bound, except now().
class SteppedClock final : public Clock {
public:
    Time now() const override { return manual_.now(); }
    void sleepUntil(Time time) override;
    void setParts(std::vector<Part> parts);
    void endAllBut(Rank rank);  // as in PartThreads

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
