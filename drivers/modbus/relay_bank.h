#pragma once

#include "drivers/common/opening.h"
#include "drivers/modbus/bus.h"

#include "device/relay_bank.h"

#include "core/config/config.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace fantascope::drivers {

// Relays at coils of a Modbus unit, or at holding registers with a value for on and one for off.
class ModbusRelayBank final : public RelayBank {
public:
    static Result<Opening<RelayBank>> readTcp(const ConfigNode& options, const std::string& name,
                                              const std::vector<bool>& safeStates);
    static Result<Opening<RelayBank>> readRtu(const ConfigNode& options, const std::string& name,
                                              const std::vector<bool>& safeStates);
    ~ModbusRelayBank() override;

    DeviceStatus status() const override { return unit_.status(); }
    std::size_t size() const override { return safeStates_.size(); }
    Result<void> write(const std::vector<bool>& states) override;
    Result<std::vector<bool>> read() override;

private:
    // A register of the module that must be written again and again, or the module sets its relays
    // to the safe states by itself.
    struct Watchdog {
        int address = 0;
        std::vector<std::uint16_t> values{1};  // in turn
        Time period = std::chrono::milliseconds(250);
    };
    struct Options {
        ModbusLineOptions line;
        ModbusPlace place;
        std::uint16_t on = 1, off = 0;
        bool oneByOne = false;                   // one request per relay
        Time timeout = std::chrono::seconds(1);  // of a whole write() or read()
        double rate = 4;                         // Hz; how often the module is checked
        std::optional<Watchdog> watchdog;
    };
    static Result<Opening<RelayBank>> fromConfig(const char* driver, ModbusLineOptions line, const ConfigNode& node,
                                                 const std::string& name, const std::vector<bool>& safeStates);
    static Result<Watchdog> watchdogOf(const ConfigNode& node);
    ModbusRelayBank(std::string name, const char* driver, Options options, std::shared_ptr<ModbusBus> bus,
                    const std::vector<bool>& safeStates);

    bool used_ = false;  // write() was called

    // On the bus's thread:
    ModbusUnit::TurnResult turn(ModbusLine& line);
    ModbusOutcome feed(ModbusLine& line, Time deadline);
    ModbusOutcome set(ModbusLine& line, const std::vector<std::uint16_t>& values, Time deadline);

    const Options options_;
    const std::vector<bool> safeStates_;
    const Clock& clock_;
    // Used only by the bus's thread:
    // The values confirmed since the last loss. While it is empty nothing is written, not even to
    // the watchdog, which keeps the relays safe.
    std::vector<std::uint16_t> confirmed_;
    std::size_t feeds_ = 0;  // writes to the watchdog
    Time nextFeed_{}, nextCheck_{};
    ModbusUnit unit_;
};

}  // namespace fantascope::drivers
