#pragma once

#include "drivers/site/plug.h"

#include "device/input_bank.h"
#include "device/relay_bank.h"

#include "core/config/config.h"

#include <deque>
#include <memory>
#include <string>
#include <vector>

namespace fantascope::drivers {

// A bank of relays at the simulated site. Its watchdog notices a dead line at once. Plug: the
// bank's name.
class SimulatedRelayBank final : public RelayBank {
public:
    static Result<Opening<RelayBank>> fromConfig(const ConfigNode& options, const std::string& name,
                                                 const std::vector<bool>& safeStates);
    ~SimulatedRelayBank() override;

    DeviceStatus status() const override { return plug_.status(); }
    std::size_t size() const override { return safeStates_.size(); }
    Result<void> write(const std::vector<bool>& states) override;
    Result<std::vector<bool>> read() override;

private:
    SimulatedRelayBank(site::Plug plug, std::vector<bool> safeStates)
        : plug_(std::move(plug)), safeStates_(std::move(safeStates)) {}
    site::Plug plug_;
    std::vector<bool> safeStates_;
    bool used_ = false;  // write() was called
};

// A bank of contacts at the simulated site. Plug: the bank's name.
class SimulatedInputBank final : public InputBank {
public:
    static Result<Opening<InputBank>> fromConfig(const ConfigNode& options, const std::string& name, std::size_t size);

    DeviceStatus status() const override { return plug_.status(); }
    std::size_t size() const override { return reported_.size(); }
    std::optional<ContactChange> poll() override;

private:
    SimulatedInputBank(site::Plug plug, std::size_t size) : plug_(std::move(plug)), reported_(size, false) {}
    site::Plug plug_;
    std::vector<bool> reported_;         // as last reported
    bool looking_ = false;               // read since the start or the last loss
    std::deque<ContactChange> waiting_;  // not taken yet
};

}  // namespace fantascope::drivers
