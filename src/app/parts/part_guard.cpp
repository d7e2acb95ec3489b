#include "app/parts/part_guard.h"

#include <fmt/format.h>

#include <exception>
#include <memory>
#include <utility>

namespace fantascope::app {

PartGuard::PartGuard(std::string part, Rank rank, FaultLog& faults)
    : part_(std::move(part)), rank_(rank), faults_(faults), backOff_(kSoonest, rank == Rank::Input ? kLatestInput : kLatest) {}

bool PartGuard::run(Time moment, const std::function<void(Time)>& work) {
    if (moment < nextTry_) return false;
    try {
        work(moment);
    } catch (const std::exception& failure) {
        tellFailure(moment, failure.what());
        return false;
    } catch (...) {
        tellFailure(moment, "of unknown kind");
        return false;
    }
    if (std::exchange(failed_, false)) tellRecovery(moment);
    return true;
}

// The report may fail, too, if the machine has no memory left. Then the next failure is reported.
void PartGuard::tellFailure(Time moment, const char* why) noexcept {
    const Time pause = backOff_.failed(moment);
    nextTry_ = rank_ == Rank::Lighting ? Time::min() : moment + pause;
    failed_ = true;
    try {
        faults_.raise(moment, part_, FaultLog::Topic::Part,
                      fmt::format("the part '{}' failed: {}; it is tried again, and the rest plays on", part_, why));
    } catch (...) {
    }
}

void PartGuard::tellRecovery(Time moment) noexcept {
    backOff_.succeeded(moment);
    try {
        faults_.clear(moment, part_, FaultLog::Topic::Part, fmt::format("the part '{}' works again", part_));
    } catch (...) {
    }
}

Part guarded(Part part, FaultLog& faults) {
    auto guard = std::make_shared<PartGuard>(part.name, part.rank, faults);
    part.work = [guard = std::move(guard), work = std::move(part.work)](Time moment) { guard->run(moment, work); };
    return part;
}

std::vector<Part> guarded(std::vector<Part> parts, FaultLog& faults) {
    for (Part& part : parts) part = guarded(std::move(part), faults);
    return parts;
}

}  // namespace fantascope::app
