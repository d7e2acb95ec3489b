#pragma once

#include "drivers/common/file_handle.h"
#include "drivers/common/opening.h"
#include "drivers/common/usb_identity.h"

#include "core/clock.h"
#include "core/config/config.h"

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

// The address of values. Addresses count from 0, as on the wire: coil 00001 and register 40001 of
// many manuals are 0 here.
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

// A serial line, identified by its file or by its USB adapter. If several adapters match, the first
// by USB path is used.
struct ModbusRtu {
    enum class Parity { Even, Odd, None };
    std::string device;
    std::string usbVendor, usbProduct, usbSerial;  // "" matches any
    int baud = 19200;
    Parity parity = Parity::Even;
    int stopBits = 1;
    bool rs485 = false;  // the kernel's driver switches the direction
    friend bool operator==(const ModbusRtu&, const ModbusRtu&) = default;
};

struct ModbusLineOptions {
    std::variant<ModbusTcp, ModbusRtu> wire;
    Time responseTimeout = std::chrono::milliseconds(300);  // per request
    friend bool operator==(const ModbusLineOptions&, const ModbusLineOptions&) = default;
};

// Declares the keys of the line in options.wire; checkLine() checks their combinations.
void declareLine(ConfigFields& fields, ModbusLineOptions& options);
Result<void> checkLine(const ConfigNode& node, const ModbusLineOptions& options);
// The same for the unit and the address of its values. checkPlace() also checks that `count` values
// fit from there on.
void declareUnit(ConfigFields& fields, const ModbusLineOptions& line, ModbusPlace& place);
Result<void> checkPlace(const ConfigNode& node, const ModbusPlace& place, std::size_t count, bool writing);
// "10.0.0.5:502", "/dev/ttyUSB0", "the USB adapter 0403:6001 serial A5".
std::string nameOf(const ModbusLineOptions& options);
// Devices share a line if they use it with the same settings.
Use useOf(const ModbusLineOptions& options);
// The name for Opening::claim of a serial line: the file that it would open now, else the adapter
// that it waits for.
std::string claimOf(const ModbusRtu& wire);

// Whether the line named by its USB adapter may be on this one.
bool isOn(const ModbusRtu& wire, const UsbIdentity& usb);

// Why a request failed: the state of the unit now, or of the whole line with all its units.
struct ModbusFailure {
    Outage outage;
    bool wholeLine = false;
    bool retryable = false;  // no answer, or a wrong one
    bool isRefusal = false;  // the unit answered that it will not do it
};
using ModbusOutcome = std::optional<ModbusFailure>;  // nothing: success

// One line and its requests, through libmodbus. A failure leaves no trace for the next request: a
// TCP connection is reopened, and on a serial line it waits for silence. A connection that the far
// end closed is a lost line. Every call ends by its deadline. Thread: thread-bound.
class ModbusLine {
public:
    ModbusLine(ModbusLineOptions options, const Clock& clock);

    // Connects, or opens the file, if it is not open.
    ModbusOutcome open(Time deadline);
    // One request for values.size() values, and its answer. Without an answer, or with a wrong one,
    // it is repeated once if the deadline allows; that is safe, because reading or writing a state
    // twice changes nothing. An exception is an answer.
    // A single value is written by function 5 or 6, several by function 15 or 16.
    ModbusOutcome read(const ModbusPlace& place, std::span<std::uint16_t> values, Time deadline);
    ModbusOutcome write(const ModbusPlace& place, std::span<const std::uint16_t> values, Time deadline);

    const ModbusLineOptions& options() const { return options_; }

private:
    using Request = std::function<int(_modbus*)>;  // -1 and errno, as in libmodbus
    ModbusOutcome exchange(const ModbusPlace& place, std::size_t count, bool writing, Time deadline, const Request& request);
    ModbusOutcome exchangeOnce(const ModbusPlace& place, std::size_t count, bool writing, Time deadline, const Request& request);
    ModbusOutcome waitForSilence(Time deadline);
    ModbusOutcome lost(int error);

    const ModbusLineOptions options_;
    const Clock& clock_;
    std::unique_ptr<_modbus, void (*)(_modbus*)> context_;  // null: not open
};

}  // namespace fantascope::drivers
