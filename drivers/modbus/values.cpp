#include "drivers/modbus/values.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace fantascope::drivers {
namespace {

bool isRegister(ModbusTable table) { return table == ModbusTable::HoldingRegisters || table == ModbusTable::InputRegisters; }

const char* nameOf(ModbusTable table) {
    switch (table) {
        case ModbusTable::Coils:
            return "coil";
        case ModbusTable::DiscreteInputs:
            return "discrete input";
        case ModbusTable::HoldingRegisters:
            return "holding register";
        case ModbusTable::InputRegisters:
            return "input register";
    }
    return "value";
}

}  // namespace

std::string nameOf(const ModbusPlace& place, std::size_t count) {
    if (count == 1) return fmt::format("{} {}", nameOf(place.table), place.first);
    return fmt::format("{}s {} to {}", nameOf(place.table), place.first, place.first + static_cast<int>(count) - 1);
}

std::string describeException(int code, const ModbusPlace& place, std::size_t count, bool writing) {
    const std::string what = nameOf(place, count);
    switch (code) {
        case 1:
            return fmt::format("illegal function: unit {} cannot {} {}s; see 'kind'", place.unit, writing ? "write" : "read",
                               nameOf(place.table));
        case 2:
            return fmt::format("illegal data address: unit {} does not have all of {}; check 'first' and how many are declared",
                               place.unit, what);
        case 3:
            return fmt::format("illegal data value: unit {} refuses {} {}", place.unit,
                               writing ? "what is written to" : "to read", what);
        case 4:
            return fmt::format("unit {} failed to {} {}: check the module", place.unit, writing ? "write" : "read", what);
        case 5:
        case 6:
            return fmt::format("unit {} is busy", place.unit);
        case 8:
            return fmt::format("unit {} has a memory fault: check the module", place.unit);
        case 10:
            return fmt::format("the gateway has no path to unit {}: check its settings", place.unit);
        case 11:
            return fmt::format("the gateway gets no answer from unit {}: check its power, wires and address", place.unit);
        default:
            return fmt::format("unit {} refuses {} with exception {}", place.unit, what, code);
    }
}

std::size_t maxPerRequest(ModbusTable table, bool writing) {
    if (isRegister(table)) return writing ? 123 : 125;
    return writing ? 1968 : 2000;
}

std::optional<Contact::Change> Contact::take(std::uint16_t value, Time now) {
    const int threshold = options_.threshold;
    circuitClosed_ = value >= (circuitClosed_ ? threshold - options_.hysteresis : threshold);
    const bool closed = circuitClosed_ != options_.normallyClosed, looked = std::exchange(readBefore_, true);
    if (closed == reported_) {
        seenSince_.reset();
        return std::nullopt;
    }
    if (!seenSince_) {
        seenSince_ = now;
        witnessed_ = looked;
    }
    if (now - *seenSince_ < options_.debounce) return std::nullopt;
    seenSince_.reset();
    reported_ = closed;
    return Change{closed, witnessed_};
}

}  // namespace fantascope::drivers
