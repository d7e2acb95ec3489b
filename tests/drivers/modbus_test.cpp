#include "drivers/common/back_off.h"
#include "drivers/common/usb_identity.h"
#include "drivers/modbus/find.h"
#include "drivers/modbus/input_bank.h"
#include "drivers/modbus/relay_bank.h"
#include "drivers/modbus/values.h"

#include "core/clock.h"
#include "core/config/config.h"

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace fantascope::drivers {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::StartsWith;

ConfigNode parsed(const std::string& text) { return ConfigNode::parse(text, "site.yaml").value(); }

// A contact's reports for values that come every 20 ms: "+3" closed at the fourth, "-" open, "?"
// not witnessed.
std::string reported(Contact& contact, const std::vector<int>& values) {
    std::string changes;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (const auto change = contact.take(static_cast<std::uint16_t>(values[i]), milliseconds(20) * i))
            changes += (change->closed ? "+" : "-") + std::to_string(i) + (change->witnessed ? "" : "?");
    return changes;
}
std::string reported(const ContactOptions& options, const std::vector<int>& values) {
    Contact contact(options);
    return reported(contact, values);
}

TEST(ModbusContact, is_open_at_first_and_tells_each_change_once) {
    EXPECT_EQ(reported({}, {0, 0, 1, 1, 0, 0}), "+2-4");
    EXPECT_EQ(reported({}, {1, 1}), "+0?");
}

// An emergency button opens its circuit.
TEST(ModbusContact, is_closed_while_the_circuit_of_a_normally_closed_one_is_open) {
    EXPECT_EQ(reported({.normallyClosed = true}, {1, 1, 0, 1}), "+2-3");
    EXPECT_EQ(reported({.normallyClosed = true}, {0}), "+0?");
}

// Example failure: a register that fluctuates around its threshold makes a door open and close.
TEST(ModbusContact, opens_only_below_threshold_less_hysteresis) {
    EXPECT_EQ(reported({.threshold = 500, .hysteresis = 50}, {499, 500, 499, 450, 449, 499, 500}), "+1-4+6");
    EXPECT_EQ(reported({.threshold = 500}, {500, 499, 65535}), "+0?-1+2");
}

TEST(ModbusContact, must_be_seen_so_for_as_long_as_it_bounces) {
    const ContactOptions options{.debounce = milliseconds(40)};
    EXPECT_EQ(reported(options, {1, 1, 0, 1, 1, 1, 0, 1, 0, 0, 0}), "+5-10");
    EXPECT_EQ(reported(options, {1, 0, 1, 0, 1, 0}), "");
}

// What was seen before a loss says nothing about the time in between.
TEST(ModbusContact, begins_its_debounce_anew_after_an_interruption) {
    Contact contact({.debounce = milliseconds(40)});
    EXPECT_EQ(contact.take(1, milliseconds(0)), std::nullopt);
    contact.interrupt();
    EXPECT_EQ(contact.take(1, milliseconds(60)), std::nullopt);
    EXPECT_EQ(contact.take(1, milliseconds(100)), (Contact::Change{true, false}));
}

TEST(ModbusBackOff, waits_longer_after_every_failure_up_to_a_limit) {
    BackOff backOff;
    std::vector<Time> pauses;
    for (int time = 0; time < 6; ++time) pauses.push_back(backOff.failed(milliseconds(time)));
    EXPECT_THAT(pauses, testing::ElementsAre(milliseconds(50), milliseconds(100), milliseconds(200), milliseconds(400),
                                             milliseconds(400), milliseconds(400)));
}

TEST(ModbusBackOff, begins_soon_after_a_life_and_not_after_a_moment) {
    BackOff backOff;
    for (int time = 0; time < 6; ++time) backOff.failed({});
    backOff.succeeded(milliseconds(1000));
    EXPECT_EQ(backOff.failed(milliseconds(1100)), milliseconds(400)) << "it is lost as soon as it is found";
    backOff.succeeded(milliseconds(2000));
    EXPECT_EQ(backOff.failed(milliseconds(9000)), milliseconds(50));
}

TEST(ModbusExceptions, are_told_in_words) {
    const ModbusPlace coils{7, ModbusTable::Coils, 200}, registers{7, ModbusTable::HoldingRegisters, 3};
    EXPECT_EQ(describeException(1, coils, 4, true), "illegal function: unit 7 cannot write coils; see 'kind'");
    EXPECT_EQ(describeException(2, coils, 4, false),
              "illegal data address: unit 7 does not have all of coils 200 to 203; check 'first' and how many are declared");
    EXPECT_EQ(describeException(3, registers, 1, true),
              "illegal data value: unit 7 refuses what is written to holding register 3");
    EXPECT_THAT(describeException(11, coils, 4, false), HasSubstr("the gateway gets no answer from unit 7"));
    EXPECT_THAT(describeException(99, coils, 4, false), HasSubstr("exception 99"));
}

// Keys are refused before anything opens.
class ModbusKeys : public testing::Test {
protected:
    std::string relays(const std::string& text, std::size_t count = 3, bool tcp = true) {
        const auto read =
            (tcp ? ModbusRelayBank::readTcp : ModbusRelayBank::readRtu)(parsed(text), "relays", std::vector<bool>(count));
        return read ? "" : read.error().message();
    }
    std::string contacts(const std::string& text, std::size_t count = 3) {
        const auto read = ModbusInputBank::readTcp(parsed(text), "contacts", count);
        if (!read) return read.error().message();
        const auto opened = read->open(context_);
        return opened ? "" : opened.error().message();
    }
    SteadyClock clock_;
    DriverContext context_{clock_};
    const std::string tcp_ = "driver: modbus_tcp\nhost: 127.0.0.1\nport: 1\n";
    const std::string rtu_ = "driver: modbus_rtu\ndevice: /dev/none\n";
};

TEST_F(ModbusKeys, with_good_ones_a_device_that_is_not_there_opens) {
    EXPECT_EQ(relays(tcp_), "");
    EXPECT_EQ(relays(tcp_ + "unit: 255\nfirst: 65533\nkind: holding_registers\non: 256\noff: 512\n"
                            "watchdog: {register: 9, values: [1, 2], period: 0.2}\n"),
              "");
    EXPECT_EQ(relays(rtu_ + "baud: 9600\nparity: none\nstop_bits: 2\nunit: 247\n", 3, false), "");
    EXPECT_EQ(relays("driver: modbus_rtu\nusb: {vendor: \"0403\", serial: A5}\n", 3, false), "");
    EXPECT_EQ(contacts(tcp_ + "kind: input_registers\nthreshold: 500\nhysteresis: 20\ndebounce: 0.02\nnormally_closed: [0, 2]\n"),
              "");
}

TEST_F(ModbusKeys, bad_ones_are_refused_with_their_place) {
    EXPECT_THAT(relays("driver: modbus_tcp\nhost: relays.local\n"),
                StartsWith("site.yaml:2:7: host: 'relays.local' is not an IPv4 address"));
    EXPECT_THAT(relays(tcp_ + "unit: 250\n"), StartsWith("site.yaml:4:7: unit: 250 is reserved"));
    EXPECT_THAT(relays(tcp_ + "watchdogs: {}\n"), StartsWith("site.yaml:4:1: watchdogs: unknown key (did you mean 'watchdog'?)"));
    EXPECT_THAT(relays(tcp_ + "kind: discrete_inputs\n"), StartsWith("site.yaml:4:7: kind"));
    EXPECT_THAT(relays(tcp_ + "watchdog: {period: 1}\n"), HasSubstr("watchdog"));
    EXPECT_THAT(relays(rtu_ + "unit: 255\n", 3, false), StartsWith("site.yaml:3:7: unit"));
    EXPECT_THAT(relays("driver: modbus_rtu\ndevice: ttyUSB0\n", 3, false),
                StartsWith("site.yaml:2:9: device: 'ttyUSB0' is not a device"));
    EXPECT_THAT(relays("driver: modbus_rtu\nusb: {vendor: 403}\n", 3, false), HasSubstr("four hexadecimal digits"));
    EXPECT_THAT(contacts(tcp_ + "normally_closed: [3]\n"), StartsWith("site.yaml:4:19: normally_closed[0]"));
}

TEST_F(ModbusKeys, that_do_not_go_together_are_refused) {
    EXPECT_THAT(relays("driver: modbus_rtu\n", 3, false), HasSubstr("either 'device' or 'usb' is needed"));
    EXPECT_THAT(relays(rtu_ + "usb: {serial: A5}\n", 3, false), HasSubstr("either 'device' or 'usb' is needed"));
    EXPECT_THAT(relays(rtu_ + "baud: 19201\n", 3, false), HasSubstr("'baud' is 19201, one of 1200, 1800,"));
    EXPECT_THAT(relays(tcp_ + "on: 2\n"), HasSubstr("'on' and 'off' are for 'kind: holding_registers'"));
    EXPECT_THAT(relays(tcp_ + "kind: holding_registers\non: 0\n"), HasSubstr("the same value"));
    EXPECT_THAT(relays(tcp_ + "timeout: 0.5\n"), HasSubstr("three times 'response_timeout' is needed: 0.9 s"));
    EXPECT_THAT(contacts(tcp_ + "threshold: 5\n"), HasSubstr("are for registers"));
    EXPECT_THAT(contacts(tcp_ + "kind: input_registers\nthreshold: 5\nhysteresis: 5\n"),
                HasSubstr("below 'threshold', which is 5"));
}

TEST_F(ModbusKeys, what_has_no_room_in_the_addresses_or_in_one_request_is_refused) {
    EXPECT_THAT(relays(tcp_ + "first: 65534\n"), HasSubstr("'first' is 65534 and 3 values are declared; addresses end at 65535"));
    EXPECT_THAT(relays(tcp_ + "kind: holding_registers\n", 124),
                HasSubstr("124 values are declared; one request carries 123 at most"));
    EXPECT_THAT(contacts(tcp_, 2001), HasSubstr("one request carries 2000 at most"));
}

TEST_F(ModbusKeys, of_one_line_must_be_the_same_for_all_on_it) {
    const auto first = ModbusRelayBank::readTcp(parsed(tcp_), "relays", {false}).value().open(context_).value();
    EXPECT_THAT(contacts(tcp_ + "response_timeout: 0.2\n"), HasSubstr("another device uses 127.0.0.1:1 with other settings"));
    EXPECT_EQ(contacts(tcp_ + "unit: 2\n"), "");
}

// The output of a search is copied into a site file unchanged.
TEST(ModbusLines, that_are_found_say_how_to_use_them) {
    SteadyClock clock;
    for (const char* serial : {"", "A5", "it's: \"odd\""}) {
        const FoundDevice line = modbusLineOn({"/dev/null", {"0403", "6001", "FTDI", "FT232R", serial, "1-1.4"}});
        EXPECT_EQ(line.what, "FTDI FT232R");
        EXPECT_EQ(line.where, "/dev/null");
        EXPECT_THAT(line.identity, StartsWith("USB 0403:6001"));
        EXPECT_EQ(line.why, "");
        EXPECT_TRUE(ModbusRelayBank::readRtu(parsed(line.options), "relays", {false}).value().open({clock})) << line.options;
    }
    EXPECT_THAT(modbusLineOn({"/dev/none", {}}).why, HasSubstr("/dev/none is not there"));
}

TEST(ModbusLines, are_known_by_all_that_is_said_of_their_adapter) {
    const UsbIdentity adapter{"0403", "6001", "FTDI", "FT232R", "A5", "1-1.4"};
    ModbusRtu wire;
    wire.usbSerial = "A5";
    EXPECT_TRUE(isOn(wire, adapter));
    wire.usbVendor = "0403";
    wire.usbProduct = "6001";
    EXPECT_TRUE(isOn(wire, adapter));
    wire.usbProduct = "6015";
    EXPECT_FALSE(isOn(wire, adapter));
    wire.usbProduct = "";
    wire.usbSerial = "A6";
    EXPECT_FALSE(isOn(wire, adapter));
}

}  // namespace
}  // namespace fantascope::drivers
