// Serial widgets on the kernel's own driver of FTDI's adapters, pulled and plugged in again. The
// adapters are QEMU's; their far ends are ports of the same machine. tests/vm/dmx_widgets brings it
// up; elsewhere every test here is skipped.

#include "drivers/byte_stream/serial.h"
#include "drivers/registry.h"

#include "contract/eventually.h"
#include "contract/serial_dmx_rig.h"
#include "contract/widget.h"
#include "source_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::contract {
namespace {

using drivers::FileHandle;
using Bytes = std::vector<std::uint8_t>;

std::string fileOfFarEnd(int number) { return fmt::format("/dev/virtio-ports/widget{}", number); }
std::string serial(int number) { return fmt::format("EN00000{}", number); }
// What the kernel calls the adapter; "" where it is not there.
std::string fileOf(int number) {
    const auto line = drivers::findSerialLine({.file = {}, .vendor = {}, .product = {}, .serial = serial(number)});
    return line ? line->string() : "";
}
void tellQemu(const std::string& command) {
    ASSERT_EQ(std::system(fmt::format("'{}/tests/vm/monitor' '{}'", sourceFolder(), command).c_str()), 0);
}
void pull(int number) {
    tellQemu(fmt::format("device_del adapter{}", number));
    eventually("the adapter is gone", [&] { return fileOf(number).empty(); });
}
void plugIn(int number) {
    tellQemu(fmt::format("device_add usb-serial,id=adapter{0},bus=usb.0,chardev=near{0},serial={1},always-plugged=on", number,
                         serial(number)));
    eventually("the adapter is there", [&] { return !fileOf(number).empty(); });
}

class WidgetsOnTheKernel : public testing::Test {
protected:
    void SetUp() override {
        if (!std::filesystem::exists(fileOfFarEnd(1))) GTEST_SKIP() << "no adapters here: tests/vm/dmx_widgets makes them";
        for (const int number : {1, 2}) eventually("the adapters are there", [&] { return !fileOf(number).empty(); });
    }

    std::unique_ptr<DmxPort> open(const std::string& driver, int number) {
        const auto node = ConfigNode::parse(fmt::format("driver: {}\nserial: {}\n", driver, serial(number)), "site.yaml").value();
        return drivers::openDmxPort(node, number, context_).value();
    }
    static void await(const Device& device, DeviceState state) {
        eventually(nameOf(state), [&] { return device.status().state == state; });
    }

    SteadyClock clock_;
    drivers::DriverContext context_{clock_};
};

// A widget behind one of the adapters. It has no memory of what was on the line before it was
// plugged in.
class AdapterSocket {
public:
    explicit AdapterSocket(int number)
        : number_(number),
          end_(::open(fileOfFarEnd(number).c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC)),
          widget_(std::in_place, end_.get()) {
        FANTASCOPE_CHECK(end_.isOpen(), "nobody else has the far end");
    }
    ~AdapterSocket() {
        if (!in()) plugIn();
    }
    void plugIn() {
        widget_.emplace(end_.get());
        contract::plugIn(number_);
    }
    void unplug() {
        contract::pull(number_);
        widget_.reset();
    }
    bool in() const { return widget_.has_value(); }
    // The far end takes bytes in order, and a port runs once its own question is answered.
    bool hasTakenAll() const { return true; }
    Widget& farEnd() { return *widget_; }
    std::string key() const { return "serial: " + serial(number_); }

private:
    const int number_;
    const FileHandle end_;
    std::optional<Widget> widget_;
};

TEST_F(WidgetsOnTheKernel, keep_the_contract) {
    EXPECT_THAT(violations(dmxPortSuite(),
                           [] {
                               return std::make_unique<SerialDmxPortRig<AdapterSocket>>(
                                   "enttec_pro", std::make_unique<AdapterSocket>(1), std::make_unique<AdapterSocket>(2));
                           }),
                testing::IsEmpty());
}

TEST_F(WidgetsOnTheKernel, come_back_by_another_name_with_the_right_universe_on_each) {
    const FileHandle ends[] = {FileHandle(::open(fileOfFarEnd(1).c_str(), O_RDWR | O_NONBLOCK)),
                               FileHandle(::open(fileOfFarEnd(2).c_str(), O_RDWR | O_NONBLOCK))};
    Widget widgets[] = {Widget(ends[0].get(), "00000001"), Widget(ends[1].get(), "00000002")};
    const std::unique_ptr<DmxPort> ports[] = {open("enttec_pro", 1), open("enttec_pro", 2)};
    const auto serve = [&](int first) {
        for (const int i : {0, 1}) {
            await(*ports[i], DeviceState::Running);
            ASSERT_TRUE(ports[i]->send(dmxFrame(first + i)));
        }
        for (const int i : {0, 1})
            eventually("each has its own universe", [&] { return widgets[i].out() == dmxFrame(first + i); });
    };
    serve(10);
    const std::string before[] = {fileOf(1), fileOf(2)};
    ASSERT_NE(before[0], before[1]);

    for (const int number : {1, 2}) pull(number);  // while frames go out
    for (const auto& port : ports) await(*port, DeviceState::Absent);
    // In the other order, the other names.
    const bool firstWasFirst = before[0] < before[1];
    plugIn(firstWasFirst ? 2 : 1);
    plugIn(firstWasFirst ? 1 : 2);
    const Time back = clock_.now();
    EXPECT_EQ(fileOf(1), before[1]);
    EXPECT_EQ(fileOf(2), before[0]);
    for (const auto& port : ports) await(*port, DeviceState::Running);
    fmt::print("both run again {:.2f} s after the second was plugged in\n", seconds(clock_.now() - back));
    serve(20);
    for (const auto& port : ports) EXPECT_EQ(port->status().losses, 1);
}

TEST_F(WidgetsOnTheKernel, carry_packets_with_breaks_on_a_bare_adapter) {
    const FileHandle end(::open(fileOfFarEnd(1).c_str(), O_RDWR | O_NONBLOCK));
    const auto port = open("open_dmx", 1);
    await(*port, DeviceState::Running);
    ASSERT_TRUE(port->send(dmxFrame(5)));
    // QEMU's adapter passes bytes on as fast as they come, and no break.
    Bytes arrived;
    eventually("packets", [&] {
        std::uint8_t bytes[4096];
        const ssize_t count = ::read(end.get(), bytes, sizeof bytes);
        if (count > 0) arrived.insert(arrived.end(), bytes, bytes + count);
        return arrived.size() >= 20 * (1 + kDmxSlots);
    });
    const DmxFrame frame = dmxFrame(5);
    const auto start = std::search(arrived.begin(), arrived.end(), frame.begin(), frame.end());
    ASSERT_GE(arrived.end() - start, 2 * static_cast<std::ptrdiff_t>(1 + kDmxSlots));
    EXPECT_EQ(start[static_cast<std::ptrdiff_t>(kDmxSlots)], 0) << "the start code of the next packet";
    EXPECT_TRUE(std::equal(frame.begin(), frame.end(), start + static_cast<std::ptrdiff_t>(1 + kDmxSlots)));
    pull(1);
    await(*port, DeviceState::Absent);
    plugIn(1);
    await(*port, DeviceState::Running);
}

}  // namespace
}  // namespace fantascope::contract
