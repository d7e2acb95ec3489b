#pragma once

#include "drivers/common/surroundings.h"
#include "drivers/modbus/bus.h"

#include "device/relay_bank.h"

#include "core/config.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace fantascope::drivers {

// Relays that are the coils of a Modbus unit, or holding registers with a value for on and one for
// off.
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
    // A register of the module that must be written again and again, or it switches its relays to
    // the safe states by itself.
    struct Watchdog {
        int address = 0;
        std::vector<std::uint16_t> values{1};  // in turn
        Time period = std::chrono::milliseconds(250);
    };
    struct Options {
        ModbusLineOptions line;
        ModbusPlace place;
        std::uint16_t on = 1, off = 0;
        bool oneByOne = false;                   // a request for each relay
        Time timeout = std::chrono::seconds(1);  // of a write() or read() as a whole
        double rate = 4;                         // Hz; how often it is looked whether the module is there
        std::optional<Watchdog> watchdog;
    };
    static Result<Opening<RelayBank>> fromConfig(const char* driver, ModbusLineOptions line, const ConfigNode& node,
                                                 const std::string& name, const std::vector<bool>& safeStates);
    static Result<Watchdog> watchdogOf(const ConfigNode& node);
    ModbusRelayBank(std::string name, const char* driver, Options options, std::shared_ptr<ModbusBus> bus,
                    const std::vector<bool>& safeStates);

    bool used_ = false;  // somebody asked for a write

    // On the bus's thread.
    ModbusUnit::Turned turn(ModbusLine& line);
    ModbusOutcome feed(ModbusLine& line, Time deadline);
    ModbusOutcome set(ModbusLine& line, const std::vector<std::uint16_t>& values, Time deadline);

    const Options options_;
    const std::vector<bool> safeStates_;
    const Clock& clock_;
    // Of the bus's thread:
    // What was confirmed since the last loss. While it is empty nothing is written, not even to the
    // watchdog, which keeps the relays safe.
    std::vector<std::uint16_t> standing_;
    std::size_t fed_ = 0;  // times
    Time nextFeed_{}, nextLook_{};
    ModbusUnit unit_;
};

}  // namespace fantascope::drivers
