#include "app/live/run_lights.h"

#include "app/parts/supervisor.h"

#include "core/config/config.h"

#include <fmt/format.h>

#include <string>
#include <utility>

namespace fantascope::app {
namespace {

constexpr Time kLookAgain = std::chrono::milliseconds(5);  // poll interval in await()

}  // namespace

void RunLights::await() {
    const Time latest = clock_.now() + site_.endFade + Supervisor::kSafeWithin;
    while (!lighting_.ended() && clock_.now() < latest) clock_.sleepUntil(clock_.now() + kLookAgain);
}

void RunLights::close(const std::function<void()>& terminal) {
    const std::lock_guard lock(closing_);
    if (std::exchange(closed_, true)) return;
    threads_.reset();
    terminal();
    unsafe_ = lighting_.unsafeBanks();
    unended_ = lighting_.unendedLines();
    devices_.lines.clear();
    devices_.relayBanks.clear();
    if (guard_ != nullptr && unsafe_.empty()) guard_->dismiss();
}

void RunLights::whileOpen(const std::function<void()>& work) {
    const std::lock_guard lock(closing_);
    if (!closed_) work();
}

void RunLights::raiseFaults(Time moment) {
    for (const auto& [bank, why] : unsafe_) {
        std::vector<std::string> relays;
        for (const show::Relay& relay : site_.relays)
            if (site_.relayBanks[relay.bank].name == bank) relays.push_back(relay.name + (relay.safe ? " on" : " off"));
        faults_.raise(moment, bank, FaultLog::Topic::SafeStates,
                      fmt::format("'{}' has not confirmed its safe states: {}. Check on site: {}", bank, why, listed(relays)));
    }
    for (const UnendedLine& line : unended_)
        faults_.raise(moment, fmt::format("universe {}", line.universe), FaultLog::Topic::EndLevels, sentenceOf(line));
}

}  // namespace fantascope::app
