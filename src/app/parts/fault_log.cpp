#include "app/parts/fault_log.h"

#include <fmt/format.h>

#include <algorithm>

namespace fantascope::app {
void FaultLog::add(TopicState& state, Time moment, const std::string& device, const std::string& what) {
    std::erase_if(state.recent, [&](std::size_t fault) { return moment - faults_[fault].moment > kRestless; });
    if (state.recent.size() == kBurst) {
        state.open = state.recent.back();
        state.restless = true;
        Fault& fault = faults_[*state.open];
        fault.until.reset();
        fault.what += "; it comes and goes";
        events_.append({showClock_.showTime(moment), show::event::FaultBegan{device, fault.what}});
        return;
    }
    state.open = faults_.size();
    state.recent.push_back(faults_.size());
    faults_.push_back({moment, what, device});
    events_.append({showClock_.showTime(moment), show::event::FaultBegan{device, what}});
}

void FaultLog::raise(Time moment, const std::string& device, Topic topic, const std::string& what) {
    const std::lock_guard lock(mutex_);
    TopicState& state = topics_[{device, topic}];
    state.raised = moment;
    if (state.open && (state.restless || faults_[*state.open].what == what)) return;
    if (state.open) faults_[*state.open].until = moment;
    add(state, moment, device, what);
}

void FaultLog::clear(Time moment, const std::string& device, Topic topic, const std::string& news) {
    const std::lock_guard lock(mutex_);
    const auto found = topics_.find({device, topic});
    if (found == topics_.end() || !found->second.open) return;
    TopicState& state = found->second;
    if (state.restless && moment - state.raised < kRestless) return;
    Fault& fault = faults_[*state.open];
    fault.until = state.restless ? state.raised : moment;
    state.open.reset();
    state.restless = false;
    events_.append({showClock_.showTime(moment), show::event::FaultEnded{device, news, *fault.until - fault.moment}});
}

std::vector<FaultReport> FaultLog::faults() const {
    const std::lock_guard lock(mutex_);
    std::vector<FaultReport> reports;
    for (const Fault& fault : faults_) {
        reports.push_back({showClock_.showTime(fault.moment), fault.what, fault.device});
        if (fault.until) reports.back().until = showClock_.showTime(*fault.until);
    }
    return reports;
}

std::vector<FaultReport> FaultLog::open() const {
    const std::lock_guard lock(mutex_);
    std::vector<FaultReport> reports;
    for (const auto& [topic, state] : topics_)
        if (state.open) {
            const Fault& fault = faults_[*state.open];
            reports.push_back({showClock_.showTime(fault.moment), fault.what, fault.device});
        }
    return reports;
}

void DeviceWatch::look(Time moment, std::span<const DeviceStatus> devices) {
    for (const DeviceStatus& device : devices) {
        const std::string called = fmt::format("{} ({})", device.name, device.driver);
        const int lost = device.losses - std::exchange(losses_[device.name], device.losses);
        const bool isBank = std::ranges::find(relayBanks_, device.name) != relayBanks_.end();
        const bool isGone = device.state == DeviceState::Absent || device.state == DeviceState::Faulted ||
                            (device.state == DeviceState::Starting && moment - runStart_ >= kPatience);
        if (isGone)
            faults_.raise(moment, device.name, FaultLog::Topic::Missing, fmt::format("{} is missing: {}", called, device.detail));
        else if (lost > 0 && !isBank)
            faults_.raise(moment, device.name, FaultLog::Topic::Missing, called + " was lost for a moment");
        else if (device.state == DeviceState::Running)
            faults_.clear(moment, device.name, FaultLog::Topic::Missing, called + " is back");
        if (device.state != DeviceState::Running) continue;
        if (!device.trouble.empty())
            faults_.raise(moment, device.name, FaultLog::Topic::Trouble, called + ": " + device.trouble);
        else
            faults_.clear(moment, device.name, FaultLog::Topic::Trouble, called + " is all right again");
    }
}

}  // namespace fantascope::app
