#pragma once

#include "drivers/common/file_handle.h"
#include "drivers/common/surroundings.h"
#include "drivers/common/usb_identity.h"

#include "core/clock.h"
#include "core/config.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>

struct _modbus;

namespace fantascope::drivers {

// The four tables of a Modbus unit.
enum class ModbusTable { Coils, DiscreteInputs, HoldingRegisters, InputRegisters };

// Where values stand. Addresses count from 0, as on the wire: coil 00001 and register 40001 of many
// manuals are 0 here.
struct ModbusPlace {
    int unit = 1;
    ModbusTable table = ModbusTable::Coils;
    int first = 0;
};

struct ModbusTcp {
    std::string host;  // an IPv4 address
    int port = 502;
    friend bool operator==(const ModbusTcp&, const ModbusTcp&) = default;
};

// A serial line by its file, or by the USB adapter that it hangs on; of several that fit, the first
// in the order of their USB paths.
struct ModbusRtu {
    enum class Parity { Even, Odd, None };
    std::string device;
    std::string usbVendor, usbProduct, usbSerial;  // "" fits any
    int baud = 19200;
    Parity parity = Parity::Even;
    int stopBits = 1;
    bool rs485 = false;  // the kernel's driver switches the direction
    friend bool operator==(const ModbusRtu&, const ModbusRtu&) = default;
};

struct ModbusLineOptions {
    std::variant<ModbusTcp, ModbusRtu> wire;
    Time responseTimeout = std::chrono::milliseconds(300);  // for one request
    friend bool operator==(const ModbusLineOptions&, const ModbusLineOptions&) = default;
};

// Declares the keys of the line that is in options.wire, and checks what one key alone cannot tell.
void declareLine(ConfigFields& fields, ModbusLineOptions& options);
Result<void> checkLine(const ConfigNode& node, const ModbusLineOptions& options);
// The same of which unit is meant and where its values begin, and whether `count` values have room
// from there.
void declareUnit(ConfigFields& fields, const ModbusLineOptions& line, ModbusPlace& place);
Result<void> checkPlace(const ConfigNode& node, const ModbusPlace& place, std::size_t count, bool writing);
// "10.0.0.5:502", "/dev/ttyUSB0", "the USB adapter 0403:6001 serial A5".
std::string nameOf(const ModbusLineOptions& options);
// Devices share a line that they use with the same settings.
Use useOf(const ModbusLineOptions& options);
// What a program claims of a serial line (Opening::claim): the file that it would open now, else
// the adapter that it waits for.
std::string claimOf(const ModbusRtu& wire);

// Whether a line that was asked for by its USB adapter may be the one on this.
bool isOn(const ModbusRtu& wire, const UsbIdentity& usb);

// Why a request did not succeed: what the unit is then, or the whole line with all its units.
struct ModbusFailure {
    Outage outage;
    bool ofLine = false;
    bool mayAskAgain = false;  // no answer, or not its own
    bool isRefusal = false;    // the unit's own word: it is there and will not do it
};
using ModbusOutcome = std::optional<ModbusFailure>;  // nothing: it succeeded

// One line and the requests on it, by libmodbus. Whatever went wrong leaves no trace for the next
// request: a TCP connection is made anew, a serial line is waited on until it is silent. A
// connection that the far end ended is a lost line. Every call ends by its deadline. Thread:
// thread-bound.
class ModbusLine {
public:
    ModbusLine(ModbusLineOptions options, const Clock& clock);

    // Makes the connection, or opens the file, where it is not.
    ModbusOutcome open(Time deadline);
    // One request of values.size() values, and its answer. What got no answer, or not its own, is
    // asked a second time where the deadline leaves time: a state that is read or written twice is
    // the same state. An exception is an answer.
    // A value alone is written by the function for one (5 or 6), several by the one for several (15
    // or 16).
    ModbusOutcome read(const ModbusPlace& place, std::span<std::uint16_t> values, Time deadline);
    ModbusOutcome write(const ModbusPlace& place, std::span<const std::uint16_t> values, Time deadline);

    const ModbusLineOptions& options() const { return options_; }

private:
    using Request = std::function<int(_modbus*)>;  // -1 and errno, as libmodbus has it
    ModbusOutcome exchange(const ModbusPlace& place, std::size_t count, bool writing, Time deadline, const Request& request);
    ModbusOutcome exchangeOnce(const ModbusPlace& place, std::size_t count, bool writing, Time deadline, const Request& request);
    ModbusOutcome waitForSilence(Time deadline);
    ModbusOutcome lost(int error);

    const ModbusLineOptions options_;
    const Clock& clock_;
    std::unique_ptr<_modbus, void (*)(_modbus*)> context_;  // null: it is not open
};

}  // namespace fantascope::drivers
