#include "drivers/modbus/simulated.h"

#include "core/check.h"

namespace fantascope::drivers {

Result<std::unique_ptr<RelayBank>> SimulatedRelayBank::open(const ConfigNode& options, const std::vector<bool>& safeStates,
                                                            const Surroundings& around) {
    auto plug = TRY(site::Plug::open(options, around, "relay bank", LossAction::SafeState));
    plug.world().installRelays(safeStates);
    return std::unique_ptr<RelayBank>(new SimulatedRelayBank(std::move(plug), safeStates));
}

SimulatedRelayBank::~SimulatedRelayBank() { plug_.world().setRelays(safeStates_); }

Result<void> SimulatedRelayBank::write(const std::vector<bool>& states) {
    FANTASCOPE_CHECK(states.size() == size(), "one state for each relay");
    if (!plug_.world().setRelays(states)) return plug_.absent();
    return {};
}

Result<std::vector<bool>> SimulatedRelayBank::read() {
    if (!plug_.in()) return plug_.absent();
    return plug_.world().relays();
}

Result<std::unique_ptr<InputBank>> SimulatedInputBank::open(const ConfigNode& options, std::size_t size,
                                                            const Surroundings& around) {
    auto plug = TRY(site::Plug::open(options, around, "contacts", LossAction::Hold));
    return std::unique_ptr<InputBank>(new SimulatedInputBank(std::move(plug), size));
}

std::optional<ContactChange> SimulatedInputBank::poll() {
    // All contacts are looked at together, so that a restless one does not hide the others.
    if (waiting_.empty() && plug_.in()) {
        for (std::size_t contact = 0; contact < size(); ++contact) {
            const bool closed = plug_.world().contact(contact);
            if (closed == reported_[contact]) continue;
            reported_[contact] = closed;
            waiting_.push_back({contact, closed, plug_.world().clock().now()});
        }
    }
    if (waiting_.empty()) return std::nullopt;
    const ContactChange oldest = waiting_.front();
    waiting_.pop_front();
    return oldest;
}

}  // namespace fantascope::drivers
