#include "app/live/fault_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fantascope::app {
namespace {

std::string durationText(Time time) {
    const double whole = seconds(time);
    if (whole < 60) return fmt::format("{:.1f} s", whole);
    return fmt::format("{:.0f} min {:02.0f} s", std::floor(whole / 60), std::fmod(whole, 60));
}

}  // namespace

void FaultLog::begin(TopicState& state, Time at, const std::string& device, const std::string& what) {
    std::erase_if(state.recent, [&](std::size_t fault) { return at - faults_[fault].at > kRestless; });
    if (state.recent.size() == kBurst) {
        state.open = state.recent.back();
        state.restless = true;
        FaultReport& fault = faults_[*state.open];
        fault.until.reset();
        fault.what += "; it comes and goes";
        tell_(fault.what);
        return;
    }
    state.open = faults_.size();
    state.recent.push_back(faults_.size());
    faults_.push_back({at, what, device, {}});
    tell_(what);
}

void FaultLog::raise(Time at, const std::string& device, Topic topic, const std::string& what) {
    const std::lock_guard lock(mutex_);
    TopicState& state = topics_[{device, topic}];
    state.raised = at;
    if (state.open && (state.restless || faults_[*state.open].what == what)) return;
    if (state.open) faults_[*state.open].until = at;
    begin(state, at, device, what);
}

void FaultLog::clear(Time at, const std::string& device, Topic topic, const std::string& news) {
    const std::lock_guard lock(mutex_);
    const auto found = topics_.find({device, topic});
    if (found == topics_.end() || !found->second.open) return;
    TopicState& state = found->second;
    if (state.restless && at - state.raised < kRestless) return;
    FaultReport& fault = faults_[*state.open];
    fault.until = state.restless ? state.raised : at;
    state.open.reset();
    state.restless = false;
    if (!news.empty()) tell_(fmt::format("{} after {}", news, durationText(*fault.until - fault.at)));
}

std::vector<FaultReport> FaultLog::faults() const {
    const std::lock_guard lock(mutex_);
    return faults_;
}

void DeviceWatch::look(Time at, std::span<const DeviceStatus> devices) {
    for (const DeviceStatus& device : devices) {
        const std::string called = fmt::format("{} ({})", device.name, device.driver);
        const int lost = device.losses - std::exchange(losses_[device.name], device.losses);
        const bool isBank = std::ranges::find(relayBanks_, device.name) != relayBanks_.end();
        const bool isGone = device.state == DeviceState::Absent || device.state == DeviceState::Faulted ||
                            (device.state == DeviceState::Starting && at >= kPatience);
        if (isGone)
            faults_.raise(at, device.name, FaultLog::Topic::Missing, fmt::format("{} is missing: {}", called, device.detail));
        else if (lost > 0 && !isBank)
            faults_.raise(at, device.name, FaultLog::Topic::Missing, called + " was lost for a moment");
        else if (device.state == DeviceState::Running)
            faults_.clear(at, device.name, FaultLog::Topic::Missing, called + " is back");
        if (device.state != DeviceState::Running) continue;
        if (!device.trouble.empty())
            faults_.raise(at, device.name, FaultLog::Topic::Trouble, called + ": " + device.trouble);
        else
            faults_.clear(at, device.name, FaultLog::Topic::Trouble, called + " is all right again");
    }
}

}  // namespace fantascope::app
