#include "drivers/modbus/line.h"

#include "drivers/common/claim.h"
#include "drivers/modbus/values.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <modbus.h>
#include <poll.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <vector>

namespace fantascope::drivers {
namespace {

constexpr int kBitsOfCharacter = 11;  // with start, parity and stop bits

void closeAndFree(modbus_t* context) {
    modbus_close(context);
    modbus_free(context);
}

bool isException(int error) { return error > MODBUS_ENOBASE && error < MODBUS_ENOBASE + MODBUS_EXCEPTION_MAX; }
// Whether libmodbus reports the error about what it received; else it is the system's.
bool isLibrarys(int error) { return error > MODBUS_ENOBASE; }

void setResponseTimeout(modbus_t* context, Time limit) {
    const auto us = std::max<std::int64_t>(std::chrono::duration_cast<std::chrono::microseconds>(limit).count(), 1);
    modbus_set_response_timeout(context, static_cast<std::uint32_t>(us / 1'000'000), static_cast<std::uint32_t>(us % 1'000'000));
}

// The longest silence inside a frame (Modbus over Serial Line V1.02, section 2.5.1.1).
Time silenceOf(const ModbusRtu& wire) {
    const Time least = std::chrono::microseconds(1750);
    return std::max(least, fromSeconds(3.5 * kBitsOfCharacter / wire.baud));
}

// The line's file now; nothing while its adapter is missing.
std::optional<std::string> fileOf(const ModbusRtu& wire) {
    if (!wire.device.empty()) return wire.device;
    for (const UsbFile& file : usbFilesOf("tty"))
        if (isOn(wire, file.usb)) return file.file.string();
    return std::nullopt;
}

void declare(ConfigFields& fields, ModbusTcp& wire) {
    fields.read("host", wire.host, [](const ConfigNode& node) -> Result<std::string> {
        const std::string host = TRY(node.text());
        in_addr address{};
        if (inet_pton(AF_INET, host.c_str(), &address) == 1) return host;
        return node.error(fmt::format(
            "'{}' is not an IPv4 address such as 10.0.0.5; host names are not supported, because a look-up may take long", host));
    });
    fields.optional().integer("port", wire.port, 1, 65535);
}

void declare(ConfigFields& fields, ModbusRtu& wire) {
    fields.optional().read("device", wire.device, [](const ConfigNode& node) -> Result<std::string> {
        auto device = node.text();
        if (!device || device->starts_with("/")) return device;
        return node.error(fmt::format("'{}' is not a device file such as /dev/ttyUSB0", *device));
    });
    fields.optional().read("usb", wire, [&wire](const ConfigNode& node) -> Result<ModbusRtu> {
        ModbusRtu named = wire;
        ConfigFields usb(node);
        const auto hexadecimal = [](const ConfigNode& digits) -> Result<std::string> {
            const std::string text = TRY(digits.text());
            if (text.size() == 4 && text.find_first_not_of("0123456789abcdef") == std::string::npos) return text;
            return digits.error(fmt::format("'{}' is not four hexadecimal digits such as \"0403\"", text));
        };
        usb.optional().read("vendor", named.usbVendor, hexadecimal);
        usb.optional().read("product", named.usbProduct, hexadecimal);
        usb.optional().text("serial", named.usbSerial);
        TRY(usb.finish());
        if (named.usbVendor.empty() && named.usbProduct.empty() && named.usbSerial.empty())
            return node.error("'vendor', 'product' or 'serial' is needed");
        return named;
    });
    fields.optional().integer("baud", wire.baud, 1200, 115200);
    fields.optional().choice("parity", wire.parity, {"even", "odd", "none"});
    fields.optional().integer("stop_bits", wire.stopBits, 1, 2);
    fields.optional().boolean("rs485", wire.rs485);
}

}  // namespace

void declareLine(ConfigFields& fields, ModbusLineOptions& options) {
    std::visit([&](auto& wire) { declare(fields, wire); }, options.wire);
    fields.optional().time("response_timeout", options.responseTimeout, 0.02, 5);
}

Result<void> checkLine(const ConfigNode& node, const ModbusLineOptions& options) {
    const ModbusRtu* serial = std::get_if<ModbusRtu>(&options.wire);
    if (serial == nullptr) return {};
    const bool byUsb = !serial->usbVendor.empty() || !serial->usbProduct.empty() || !serial->usbSerial.empty();
    if (serial->device.empty() != byUsb) return node.error("either 'device' or 'usb' is needed");
    constexpr std::array kRates = {1200, 1800, 2400, 4800, 9600, 19200, 38400, 57600, 115200};
    if (std::find(kRates.begin(), kRates.end(), serial->baud) == kRates.end())
        return node.error(fmt::format("'baud' is {}, one of {} is needed", serial->baud, fmt::join(kRates, ", ")));
    return {};
}

void declareUnit(ConfigFields& fields, const ModbusLineOptions& line, ModbusPlace& place) {
    // The specification has 1 to 247. A module with a network socket of its own may also be 255;
    // one behind a gateway may not.
    const bool tcp = std::holds_alternative<ModbusTcp>(line.wire);
    fields.optional().read("unit", place.unit, [tcp](const ConfigNode& node) -> Result<int> {
        const auto unit = static_cast<int>(TRY(node.integer(1, tcp ? 255 : 247)));
        if (unit > 247 && unit < 255) return node.error(fmt::format("{} is reserved; use 1 to 247, or 255", unit));
        return unit;
    });
    fields.optional().integer("first", place.first, 0, 65535);
}

Result<void> checkPlace(const ConfigNode& node, const ModbusPlace& place, std::size_t count, bool writing) {
    const std::size_t most = maxPerRequest(place.table, writing);
    if (count > most) return node.error(fmt::format("{} values are declared; one request carries {} at most", count, most));
    if (place.first + count > 65536)
        return node.error(fmt::format("'first' is {} and {} values are declared; addresses end at 65535", place.first, count));
    return {};
}

std::string nameOf(const ModbusLineOptions& options) {
    if (const ModbusTcp* tcp = std::get_if<ModbusTcp>(&options.wire)) return fmt::format("{}:{}", tcp->host, tcp->port);
    const ModbusRtu& serial = std::get<ModbusRtu>(options.wire);
    if (!serial.device.empty()) return serial.device;
    std::string name = "the USB adapter";
    if (!serial.usbVendor.empty() || !serial.usbProduct.empty())
        name += fmt::format(" {}:{}", serial.usbVendor.empty() ? "*" : serial.usbVendor,
                            serial.usbProduct.empty() ? "*" : serial.usbProduct);
    if (!serial.usbSerial.empty()) name += " serial " + serial.usbSerial;
    return name;
}

Use useOf(const ModbusLineOptions& options) {
    std::string how = fmt::format("response_timeout {:g}", seconds(options.responseTimeout));
    if (const ModbusRtu* serial = std::get_if<ModbusRtu>(&options.wire))
        how += fmt::format(", baud {}, parity {}, stop_bits {}, rs485 {}", serial->baud,
                           std::array{"even", "odd", "none"}[static_cast<std::size_t>(serial->parity)], serial->stopBits,
                           serial->rs485);
    return {nameOf(options), how};
}

std::string claimOf(const ModbusRtu& wire) {
    const auto file = fileOf(wire);
    return file ? claimOfFile(kSerialLine, *file) : nameOf(ModbusLineOptions{wire});
}

bool isOn(const ModbusRtu& wire, const UsbIdentity& usb) {
    const auto fits = [](const std::string& wanted, const std::string& is) { return wanted.empty() || wanted == is; };
    return fits(wire.usbVendor, usb.vendor) && fits(wire.usbProduct, usb.product) && fits(wire.usbSerial, usb.serial);
}

ModbusLine::ModbusLine(ModbusLineOptions options, const Clock& clock)
    : options_(std::move(options)), clock_(clock), context_(nullptr, closeAndFree) {}

ModbusOutcome ModbusLine::open(Time deadline) {
    if (context_) return std::nullopt;
    const auto failure = [](Outage outage) { return ModbusFailure{std::move(outage), true}; };
    const Time limit = std::min(options_.responseTimeout, deadline - clock_.now());
    if (limit <= Time::zero()) return failure({DeviceState::Faulted, "no time was left to connect"});

    const ModbusTcp* tcp = std::get_if<ModbusTcp>(&options_.wire);
    const ModbusRtu* serial = std::get_if<ModbusRtu>(&options_.wire);
    const auto file = serial != nullptr ? fileOf(*serial) : std::nullopt;
    if (serial != nullptr && !file) return failure({DeviceState::Absent, nameOf(options_) + " is not plugged in"});
    constexpr char kParities[] = {'E', 'O', 'N'};
    decltype(context_) opened(tcp != nullptr ? modbus_new_tcp(tcp->host.c_str(), tcp->port)
                                             : modbus_new_rtu(file->c_str(), serial->baud,
                                                              kParities[static_cast<int>(serial->parity)], 8, serial->stopBits),
                              closeAndFree);
    if (!opened) return failure({DeviceState::Faulted, fmt::format("{}: {}", nameOf(options_), modbus_strerror(errno))});
    setResponseTimeout(opened.get(), limit);  // the only timeout of connecting
    // 0, because a byte timeout of half a second would ignore the deadline. So the response timeout
    // holds for the whole answer.
    modbus_set_byte_timeout(opened.get(), 0, 0);
    if (modbus_connect(opened.get()) != 0) {
        const int error = errno;
        if (serial != nullptr) return failure(whyNotOpened(*file, error));
        return failure({DeviceState::Absent, fmt::format("nothing answers at {}: {}", nameOf(options_), systemMessage(error))});
    }
    if (serial != nullptr && flock(modbus_get_socket(opened.get()), LOCK_EX | LOCK_NB) != 0)
        return failure(
            {DeviceState::Faulted, fmt::format("{} is in use: by another program, or by another name in this file", *file)});
    if (serial != nullptr && serial->rs485 && modbus_rtu_set_serial_mode(opened.get(), MODBUS_RTU_RS485) != 0)
        return failure(
            {DeviceState::Faulted,
             fmt::format("the serial driver of {} does not switch RS-485; most USB adapters do it themselves: leave out 'rs485'",
                         *file)});
    context_ = std::move(opened);
    return std::nullopt;
}

ModbusOutcome ModbusLine::lost(int error) {
    context_.reset();
    return ModbusFailure{{DeviceState::Absent, fmt::format("{} went away: {}", nameOf(options_), systemMessage(error))}, true};
}

// A frame begins after a silence. Whatever arrives before is noise, or a late answer to an earlier
// request.
ModbusOutcome ModbusLine::waitForSilence(Time deadline) {
    const ModbusRtu* serial = std::get_if<ModbusRtu>(&options_.wire);
    if (serial == nullptr) return std::nullopt;
    const Time silence = silenceOf(*serial);
    const timespec limit{0, silence.count()};
    pollfd line{modbus_get_socket(context_.get()), POLLIN, 0};
    while (ppoll(&line, 1, &limit, nullptr) > 0) {
        if ((line.revents & (POLLHUP | POLLERR | POLLNVAL)) != 0) return lost(EIO);
        std::array<char, 256> dropped;
        const ssize_t count = ::read(line.fd, dropped.data(), dropped.size());
        if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) return lost(count == 0 ? EIO : errno);
        if (clock_.now() >= deadline)
            return ModbusFailure{
                {DeviceState::Faulted, nameOf(options_) + " is never silent: look for noise, or for another master on it"}};
    }
    return std::nullopt;
}

ModbusOutcome ModbusLine::exchange(const ModbusPlace& place, std::size_t count, bool writing, Time deadline,
                                   const Request& request) {
    ModbusOutcome outcome = exchangeOnce(place, count, writing, deadline, request);
    // Not after an exception, which is the unit's answer, nor on a lost line, which the bus
    // reopens.
    const bool again = outcome && !outcome->wholeLine && outcome->retryable && clock_.now() < deadline;
    return again ? exchangeOnce(place, count, writing, deadline, request) : outcome;
}

ModbusOutcome ModbusLine::exchangeOnce(const ModbusPlace& place, std::size_t count, bool writing, Time deadline,
                                       const Request& request) {
    if (auto failure = open(deadline)) return failure;
    if (auto failure = waitForSilence(deadline)) return failure;
    const Time limit = std::min(options_.responseTimeout, deadline - clock_.now());
    if (limit <= Time::zero()) return ModbusFailure{{DeviceState::Faulted, nameOf(options_) + " was busy with other requests"}};
    setResponseTimeout(context_.get(), limit);
    modbus_set_slave(context_.get(), place.unit);
    if (request(context_.get()) >= 0) return std::nullopt;

    const int error = errno;
    if (isException(error)) {
        ModbusFailure refusal{{DeviceState::Faulted, describeException(error - MODBUS_ENOBASE, place, count, writing)}};
        refusal.isRefusal = error != EMBXGPATH && error != EMBXGTAR;  // those two come from a gateway
        return refusal;
    }
    const bool serial = std::holds_alternative<ModbusRtu>(options_.wire);
    // A module that hangs up may have lost power. A new connection must not hide that its relays
    // fell.
    if (error != ETIMEDOUT && !isLibrarys(error)) return lost(error);
    // The answer may still come; a new connection keeps it from being taken for another's.
    if (!serial) context_.reset();
    ModbusFailure failure{{DeviceState::Faulted, ""}, false, true};
    if (error == ETIMEDOUT)
        failure.outage.why =
            fmt::format("unit {} on {} does not answer within {:g} s: check its power, wires and address{}", place.unit,
                        nameOf(options_), seconds(options_.responseTimeout), serial ? ", and the line's rate and parity" : "");
    else
        failure.outage.why = fmt::format("unit {} on {} gives a wrong answer: {}", place.unit, nameOf(options_),
                                         isLibrarys(error) ? modbus_strerror(error) : systemMessage(error));
    return failure;
}

ModbusOutcome ModbusLine::read(const ModbusPlace& place, std::span<std::uint16_t> values, Time deadline) {
    const int count = static_cast<int>(values.size());
    return exchange(place, values.size(), false, deadline, [&](modbus_t* context) {
        if (place.table == ModbusTable::HoldingRegisters)
            return modbus_read_registers(context, place.first, count, values.data());
        if (place.table == ModbusTable::InputRegisters)
            return modbus_read_input_registers(context, place.first, count, values.data());
        std::vector<std::uint8_t> bits(values.size());
        const int done = place.table == ModbusTable::Coils ? modbus_read_bits(context, place.first, count, bits.data())
                                                           : modbus_read_input_bits(context, place.first, count, bits.data());
        if (done >= 0) std::copy(bits.begin(), bits.end(), values.begin());
        return done;
    });
}

ModbusOutcome ModbusLine::write(const ModbusPlace& place, std::span<const std::uint16_t> values, Time deadline) {
    const int count = static_cast<int>(values.size());
    return exchange(place, values.size(), true, deadline, [&](modbus_t* context) {
        if (place.table == ModbusTable::HoldingRegisters)
            return modbus_write_registers(context, place.first, count, values.data());
        std::vector<std::uint8_t> bits(values.begin(), values.end());
        return modbus_write_bits(context, place.first, count, bits.data());
    });
}

}  // namespace fantascope::drivers
