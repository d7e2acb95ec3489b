#include "drivers/modbus/simulated.h"

#include "core/check.h"

#include <utility>

namespace fantascope::drivers {

Result<Opening<RelayBank>> SimulatedRelayBank::fromConfig(const ConfigNode& options, const std::string& name,
                                                          const std::vector<bool>& safeStates) {
    return site::Plug::fromConfig<RelayBank>(options, name, LossAction::SafeState, [name, safeStates](site::Plug plug) {
        plug.world().installRelays(name, safeStates);
        return new SimulatedRelayBank(std::move(plug), safeStates);
    });
}

SimulatedRelayBank::~SimulatedRelayBank() {
    if (used_) plug_.world().setRelays(plug_.device(), safeStates_);
}

Result<void> SimulatedRelayBank::write(const std::vector<bool>& states) {
    FANTASCOPE_CHECK(states.size() == size(), "one state for each relay");
    used_ = true;
    if (!plug_.world().setRelays(plug_.device(), states)) return plug_.absent();
    return {};
}

Result<std::vector<bool>> SimulatedRelayBank::read() {
    if (!plug_.in()) return plug_.absent();
    return plug_.world().relays(plug_.device());
}

Result<Opening<InputBank>> SimulatedInputBank::fromConfig(const ConfigNode& options, const std::string& name, std::size_t size) {
    return site::Plug::fromConfig<InputBank>(options, name, LossAction::Hold,
                                             [size](site::Plug plug) { return new SimulatedInputBank(std::move(plug), size); });
}

std::optional<ContactChange> SimulatedInputBank::poll() {
    // All contacts are read together, so that a restless one cannot hide the others.
    if (plug_.lostAgain()) looking_ = false;
    if (waiting_.empty() && plug_.in()) {
        const bool witnessed = std::exchange(looking_, true);
        for (std::size_t contact = 0; contact < size(); ++contact) {
            const bool closed = plug_.world().contact(plug_.device(), contact);
            if (closed == reported_[contact]) continue;
            reported_[contact] = closed;
            waiting_.push_back({contact, closed, plug_.world().clock().now(), witnessed});
        }
    }
    if (waiting_.empty()) return std::nullopt;
    const ContactChange oldest = waiting_.front();
    waiting_.pop_front();
    return oldest;
}

}  // namespace fantascope::drivers
