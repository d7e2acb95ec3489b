#pragma once

#include "drivers/modbus/line.h"

#include <cstdint>
#include <optional>
#include <string>

namespace fantascope::drivers {

// What an exception of a unit means and what to do about it. `code` as in the Modbus Application
// Protocol V1.1b3, section 7.
std::string exceptionInWords(int code, const ModbusPlace& place, std::size_t count, bool writing);

// "coils 4 to 6", "holding register 17".
std::string nameOf(const ModbusPlace& place, std::size_t count);

// Most values of one request; what is one bank is read and written by one.
std::size_t mostAtOnce(ModbusTable table, bool writing);

// How a contact is told from the values of its table.
struct ContactOptions {
    bool normallyClosed = false;          // it is reported closed while its circuit is open
    std::uint16_t threshold = 1;          // closed from this value on ...
    std::uint16_t hysteresis = 0;         // ... and open again below threshold - hysteresis
    std::chrono::nanoseconds debounce{};  // how long it must have been seen so
};

// One contact: its values come in, its changes come out. Open at first.
class Contact {
public:
    explicit Contact(const ContactOptions& options) : options_(options) {}
    struct Change {
        bool closed = false, witnessed = true;  // as in ContactChange
        friend bool operator==(const Change&, const Change&) = default;
    };
    // What it has changed to by this value.
    std::optional<Change> take(std::uint16_t value, Time now);
    // Nobody looked for a while: what was seen before does not count for the debounce.
    void interrupt() {
        seenSince_.reset();
        looked_ = false;
    }

private:
    ContactOptions options_;
    bool circuitClosed_ = false;  // as last seen
    bool reported_ = false;
    std::optional<Time> seenSince_;  // since when it is seen other than reported
    bool looked_ = false;            // since the start or the last interruption
    bool witnessed_ = true;          // what is seen since then
};

}  // namespace fantascope::drivers
