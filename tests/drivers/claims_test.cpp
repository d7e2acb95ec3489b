#include "drivers/common/claim.h"
#include "drivers/registry.h"

#include "scratch_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

namespace fantascope::drivers {
namespace {

using testing::HasSubstr;

ConfigNode parsed(const std::string& options) { return ConfigNode::parse(options, "site.yaml").value(); }

std::string ofPort(const std::string& options, int universe = 1) {
    return readDmxPort(parsed(options), universe).value().claim();
}
std::string ofDesk(const std::string& options) { return readDmxSource(parsed(options), 1).value().claim(); }
std::string ofRelays(const std::string& options) { return readRelayBank(parsed(options), "relays", {true}).value().claim(); }
std::string ofInputs(const std::string& options) { return readInputBank(parsed(options), "gate", 1).value().claim(); }
std::string ofDisplay(const std::string& options) {
    return readDisplay(parsed(options), {"left", {320, 180}, 60}).value().claim();
}

// Two site files may describe the same thing differently.
TEST(Claims, have_the_same_name_for_the_same_device) {
    EXPECT_EQ(ofRelays("{driver: modbus_tcp, host: 10.0.0.5, first: 4}"),
              ofRelays("{driver: modbus_tcp, host: 10.0.0.5, port: 502, unit: 1, rate: 9}"));
    EXPECT_EQ(ofPort("{driver: artnet}", 18), ofPort("{driver: artnet, subnet: 1, universe: 2}", 1));
    EXPECT_EQ(ofPort("{driver: sacn, interface: 127.0.0.1}"), ofPort("{driver: sacn, interface: lo}"));
    EXPECT_EQ(ofPort("{driver: artnet, interface: 127.0.0.1}"), ofPort("{driver: artnet, interface: lo}"));
    EXPECT_EQ(ofDisplay("{driver: glfw, monitor: HDMI-1}"), ofDisplay("{driver: glfw, monitor: {connector: HDMI-1}}"));
}

TEST(Claims, of_whatever_hangs_on_a_serial_line_are_the_lines) {
    const ScratchFolder folder;
    const auto line = folder.file("line", "");
    std::filesystem::create_symlink(line, folder / "by-id");
    const std::string port = fmt::format("port: {}}}", (folder / "by-id").string());
    const std::string device = fmt::format("{{driver: modbus_rtu, device: {}}}", line.string());
    const std::string claim = "serial line " + std::filesystem::canonical(line).string();
    EXPECT_EQ(ofRelays(device), claim);
    EXPECT_EQ(ofInputs(device), claim);
    EXPECT_EQ(ofPort("{driver: enttec_pro, " + port), claim);
    EXPECT_EQ(ofPort("{driver: open_dmx, " + port), claim);
    EXPECT_EQ(ofDesk("{driver: enttec_pro, " + port), claim);
}

// Otherwise two runs that wait for one adapter would both begin, and fight for it when it comes.
TEST(Claims, of_what_is_not_there_are_what_is_looked_for) {
    EXPECT_EQ(ofRelays("{driver: modbus_rtu, usb: {serial: none-such}}"), "the USB adapter serial none-such");
    EXPECT_EQ(ofPort("{driver: open_dmx, serial: none-such}"), "the USB adapter serial none-such");
    EXPECT_EQ(ofPort("{driver: enttec_pro, number: '12345678'}"), "the DMX widget 12345678");
    EXPECT_EQ(readCueController(parsed("{driver: usb_hid, serial: none-such}")).value().claim(),
              "cue controller with serial none-such");
    EXPECT_EQ(readCamera(parsed("{driver: v4l2, serial: none-such}")).value().claim(), "camera with the serial number none-such");
}

TEST(Claims, tell_devices_apart_that_do_not_disturb_each_other) {
    const std::string module = ofRelays("{driver: modbus_tcp, host: 10.0.0.5}");
    EXPECT_EQ(module, "Modbus module 10.0.0.5:502 unit 1");
    EXPECT_NE(ofRelays("{driver: modbus_tcp, host: 10.0.0.6}"), module);
    EXPECT_NE(ofRelays("{driver: modbus_tcp, host: 10.0.0.5, unit: 2}"), module);
    EXPECT_EQ(ofPort("{driver: sacn, interface: none-such}", 2), "sACN universe 2 on none-such");
    EXPECT_NE(ofPort("{driver: sacn}", 1), ofPort("{driver: sacn}", 2));
    EXPECT_NE(ofPort("{driver: sacn}"), ofPort("{driver: artnet}"));
    EXPECT_NE(ofPort("{driver: artnet, node: 10.0.0.5}"), ofPort("{driver: artnet, node: 10.0.0.6}"));
    EXPECT_NE(ofDisplay("{driver: glfw, monitor: HDMI-1}"), ofDisplay("{driver: glfw, monitor: HDMI-2}"));
}

TEST(Claims, leave_to_all_what_many_may_use) {
    EXPECT_EQ(ofPort("{driver: simulated}"), "");
    EXPECT_EQ(ofDesk("{driver: sacn}"), "");
    EXPECT_EQ(ofDesk("{driver: artnet}"), "");
    EXPECT_EQ(ofInputs("{driver: modbus_tcp, host: 10.0.0.5}"), "");
    EXPECT_EQ(ofDisplay("{driver: headless}"), "");
    EXPECT_EQ(ofDisplay("{driver: glfw}"), "") << "a window of the desktop";
}

TEST(Claim, is_one_programs_and_names_it_until_it_ends) {
    const std::string name = fmt::format("a test of process {}", getpid());
    EXPECT_FALSE(isClaimed(name));
    {
        const auto claim = Claim::take(name);
        ASSERT_TRUE(claim);
        EXPECT_FALSE(Claim::take(name));
        EXPECT_TRUE(isClaimed(name));
        const auto holder = holderOf(name);
        ASSERT_TRUE(holder);
        EXPECT_EQ(holder->process, getpid());
        EXPECT_THAT(holder->words(), HasSubstr(holder->command));
    }
    EXPECT_FALSE(holderOf(name));
    EXPECT_TRUE(Claim::take(name)) << "it is free again";
}

// Example failure: after kill -9, a new show begins while the old one's relay guard still switches.
TEST(Claim, goes_over_to_a_child_when_its_maker_dies) {
    const std::string name = fmt::format("an inheritance of process {}", getpid());
    int ready[2], release[2];
    ASSERT_EQ(pipe(ready) + pipe(release), 0);
    const pid_t maker = fork();
    if (maker == 0) {
        const auto claim = Claim::take(name);
        if (fork() == 0) {
            close(release[1]);
            char byte = 0;
            _exit(write(ready[1], "r", 1) == 1 && read(release[0], &byte, 1) == 0 ? 0
                                                                                  : 1);  // holds it until the test releases it
        }
        for (;;) pause();
    }
    close(ready[1]);
    char byte = 0;
    ASSERT_EQ(read(ready[0], &byte, 1), 1);
    kill(maker, SIGKILL);
    waitpid(maker, nullptr, 0);
    const auto holder = holderOf(name);
    ASSERT_TRUE(holder);
    EXPECT_EQ(holder->process, maker);
    EXPECT_TRUE(holder->hasEnded());
    close(release[1]);
    EXPECT_EQ(read(ready[0], &byte, 1), 0) << "the child has ended";
    EXPECT_FALSE(isClaimed(name));
}

}  // namespace
}  // namespace fantascope::drivers
