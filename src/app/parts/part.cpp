#include "app/parts/part.h"

#include "core/check.h"

#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>

namespace fantascope::app {

void setThreadRank(Rank rank) {
    const sched_param realTime{.sched_priority = 1}, ordinary{.sched_priority = 0};
    if (rank == Rank::Render && sched_setscheduler(0, SCHED_RR, &realTime) == 0) return;
    sched_setscheduler(0, SCHED_OTHER, &ordinary);
    // On Linux, scheduling policy and niceness belong to the thread. A refusal leaves them
    // unchanged.
    constexpr int kNiceness[] = {-10, -5, 0, 10};
    [[maybe_unused]] const int refused =
        setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), kNiceness[static_cast<std::size_t>(rank)]);
}

PartThreads::PartThreads(Clock& clock, std::vector<Part> parts) {
    for (Part& part : parts) {
        const Rank rank = part.rank;
        threads_.push_back({rank, std::jthread([&clock, part = std::move(part)](const std::stop_token& stop) {
                                setThreadRank(part.rank);  // a new thread inherits the rank of its creator
                                for (std::int64_t next = 0; !stop.stop_requested();) {
                                    clock.sleepUntil(part.phase + tickTime(next, part.rate));
                                    next = std::max(next, tickAt(clock.now() - part.phase, part.rate));
                                    if (stop.stop_requested()) break;
                                    part.work(part.phase + tickTime(next, part.rate));
                                    ++next;
                                }
                            })});
    }
}

PartThreads::~PartThreads() {
    for (Running& running : threads_) running.thread.request_stop();
}

void PartThreads::endAllBut(Rank rank) {
    for (Running& running : threads_)
        if (running.rank != rank) running.thread.request_stop();
    std::erase_if(threads_, [&](const Running& running) { return running.rank != rank; });
}

void SteppedClock::setParts(std::vector<Part> parts) {
    parts_.clear();
    for (Part& part : parts) parts_.push_back({std::move(part)});
}

void SteppedClock::endAllBut(Rank rank) {
    std::erase_if(parts_, [&](const Scheduled& scheduled) { return scheduled.part.rank != rank; });
}

void SteppedClock::sleepUntil(Time time) {
    FANTASCOPE_CHECK(!stepping_, "a part may not sleep on the clock that steps it");
    stepping_ = true;
    for (;;) {
        const auto next = std::min_element(parts_.begin(), parts_.end(),
                                           [](const Scheduled& a, const Scheduled& b) { return a.due() < b.due(); });
        if (next == parts_.end() || next->due() > time) break;
        const Time moment = next->due();
        manual_.advanceTo(moment);
        ++next->next;
        next->part.work(moment);
    }
    stepping_ = false;
    manual_.advanceTo(time);
}

}  // namespace fantascope::app
