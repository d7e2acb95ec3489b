#pragma once

#include "drivers/modbus/line.h"

#include <cstdint>
#include <optional>
#include <string>

namespace fantascope::drivers {

// The meaning of a unit's exception and what to do about it. `code` as in the Modbus Application
// Protocol V1.1b3, section 7.
std::string describeException(int code, const ModbusPlace& place, std::size_t count, bool writing);

// "coils 4 to 6", "holding register 17".
std::string nameOf(const ModbusPlace& place, std::size_t count);

// The most values of one request; a bank is read and written by one.
std::size_t maxPerRequest(ModbusTable table, bool writing);

// How a value of its table becomes the state of a contact.
struct ContactOptions {
    bool normallyClosed = false;          // reported closed while its circuit is open
    std::uint16_t threshold = 1;          // closed from this value on ...
    std::uint16_t hysteresis = 0;         // ... and open again below threshold - hysteresis
    std::chrono::nanoseconds debounce{};  // how long a change must last
};

// Turns the values of one contact into changes. Open at first.
class Contact {
public:
    explicit Contact(const ContactOptions& options) : options_(options) {}
    struct Change {
        bool closed = false, witnessed = true;  // as in ContactChange
        friend bool operator==(const Change&, const Change&) = default;
    };
    // The change by this value; nothing if there is none.
    std::optional<Change> take(std::uint16_t value, Time now);
    // Call when the contact was not read for a while: what was seen before does not count for the
    // debounce.
    void interrupt() {
        seenSince_.reset();
        readBefore_ = false;
    }

private:
    ContactOptions options_;
    bool circuitClosed_ = false;  // as last seen
    bool reported_ = false;
    std::optional<Time> seenSince_;  // since when it differs from the report
    bool readBefore_ = false;        // read since the start or the last interruption
    bool witnessed_ = true;          // of the change since seenSince_
};

}  // namespace fantascope::drivers
