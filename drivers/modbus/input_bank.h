#pragma once

#include "drivers/common/opening.h"
#include "drivers/modbus/bus.h"
#include "drivers/modbus/values.h"

#include "device/input_bank.h"

#include "core/config/config.h"

#include <deque>
#include <memory>
#include <mutex>
#include <vector>

namespace fantascope::drivers {

// Contacts at discrete inputs, coils or registers of a Modbus unit.
class ModbusInputBank final : public InputBank {
public:
    static Result<Opening<InputBank>> readTcp(const ConfigNode& options, const std::string& name, std::size_t size);
    static Result<Opening<InputBank>> readRtu(const ConfigNode& options, const std::string& name, std::size_t size);

    DeviceStatus status() const override { return unit_.status(); }
    std::size_t size() const override { return contacts_.size(); }
    std::optional<ContactChange> poll() override;

private:
    struct Options {
        ModbusLineOptions line;
        ModbusPlace place{1, ModbusTable::DiscreteInputs, 0};
        std::vector<ContactOptions> contacts;
        double rate = 50;  // Hz
    };
    static Result<Opening<InputBank>> fromConfig(const char* driver, ModbusLineOptions line, double rate, const ConfigNode& node,
                                                 const std::string& name, std::size_t size);
    ModbusInputBank(std::string name, const char* driver, Options options, std::shared_ptr<ModbusBus> bus);
    ModbusUnit::TurnResult turn(ModbusLine& line);  // on the bus's thread

    const Options options_;
    const Clock& clock_;
    std::vector<Contact> contacts_;  // used only by the bus's thread; their number is constant
    std::mutex mutex_;
    std::deque<ContactChange> waiting_;  // not taken yet
    ModbusUnit unit_;
};

}  // namespace fantascope::drivers
