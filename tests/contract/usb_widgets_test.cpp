// Widgets identified by what they report, on a umockdev machine whose /sys lists them like the
// kernel.

#include "drivers/byte_stream/serial.h"
#include "drivers/dmx/widget_search.h"
#include "drivers/registry.h"

#include "contract/dmx_port_suite.h"
#include "contract/eventually.h"
#include "contract/pseudo_terminal.h"
#include "contract/widget.h"

#include <gmock/gmock.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <umockdev.h>
#include <unistd.h>

#include <cerrno>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

namespace fantascope::contract {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// An adapter's description, and the number of the widget behind it.
struct Adapter {
    std::string port;    // of the USB bus: "1-1"
    std::string name;    // its name
    std::string serial;  // the adapter's serial number
    std::string number;  // the widget's number
};
const Adapter kLeft{"1-1", "DMX USB PRO", "EN100001", "00000001"}, kRight{"1-2", "DMX USB PRO", "EN100002", "00000002"},
    kBare{"1-3", "FT232R USB UART", "AB0CD1EF", "00000003"};

// The file that answers for a line while it is plugged in.
struct Answering {
    std::mutex mutex;
    int file = -1;
};

// Asks the kernel, bypassing umockdev. umockdev may confuse this file's number with that of a line
// that a driver has just closed, and then pass the request to the very thread that asks.
int askKernel(int file, unsigned long request, void* argument) {
    return static_cast<int>(syscall(SYS_ioctl, file, request, argument));
}

// A program's requests on a line's file pass through umockdev, on a thread of its own, even after
// the line is gone. This is a GLib signal handler.
gboolean passOn(UMockdevIoctlBase*, UMockdevIoctlClient* client, void* answering) {
    auto& [mutex, file] = *static_cast<Answering*>(answering);
    const std::lock_guard lock(mutex);
    const unsigned long request = umockdev_ioctl_client_get_request(client) & 0xffffffff;
    UMockdevIoctlData* const argument = umockdev_ioctl_client_get_arg(client);
    int result = -1;
    errno = ENOTTY;  // a pseudo-terminal has no adapter
    if (request == TIOCEXCL || request == TIOCNXCL || request == TCFLSH) {
        result = askKernel(file, request, *reinterpret_cast<void* const*>(argument->data));
    } else if (const unsigned size = _IOC_SIZE(request); size > 0) {  // the settings
        UMockdevIoctlData* const pointed = umockdev_ioctl_data_resolve(argument, 0, size, nullptr);
        std::vector<std::uint8_t> settings(pointed->data, pointed->data + size);
        result = askKernel(file, request, settings.data());
        umockdev_ioctl_data_update(pointed, 0, settings.data(), static_cast<gint>(size));
        umockdev_ioctl_data_unref(pointed);
    }
    umockdev_ioctl_client_complete(client, result, result < 0 ? errno : 0);
    return TRUE;
}

class Machine {
public:
    Machine() : testbed_(umockdev_testbed_new(), g_object_unref) {
        char* const root = umockdev_testbed_get_root_dir(testbed_.get());
        dev_ = fs::path(root) / "dev";
        g_free(root);
        fs::create_directories(dev_);
    }

    ~Machine() {
        while (!plugged_.empty()) unplug(plugged_.begin()->first);
        while (!answers_.empty()) hush(answers_.begin()->first);
    }

    // Lists an adapter like the kernel; its file need not exist. Returns the folders.
    std::vector<std::string> list(const Adapter& adapter, const std::string& file) {
        const std::string device = "/devices/pci0000:00/0000:00:14.0/usb1/" + adapter.port;
        const std::string interface = device + "/" + adapter.port + ":1.0";
        add(
            fmt::format("P: {}\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nA: idVendor=0403\nA: idProduct=6001\n"
                        "A: manufacturer=ENTTEC\nA: product={}\nA: serial={}\n",
                        device, adapter.name, adapter.serial));
        add(fmt::format("P: {}\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_interface\nA: bInterfaceNumber=00\n", interface));
        add(fmt::format("P: {0}/{1}/tty/{1}\nE: SUBSYSTEM=tty\nE: DEVNAME=/dev/{1}\n", interface, file));
        return {fmt::format("/sys{0}/{1}/tty/{1}", interface, file), "/sys" + interface, "/sys" + device};
    }

    Widget& plugIn(const Adapter& adapter, const std::string& file) {
        Plugged& plugged = plugged_[file];
        plugged.folders = list(adapter, file);
        plugged.widget = std::make_unique<Widget>(plugged.line.far(), adapter.number);
        plugged.answering = &answering_.emplace_back();
        plugged.answering->file = plugged.line.near();
        hush(file);
        UMockdevIoctlBase* const answers = answers_[file] = umockdev_ioctl_base_new();
        g_signal_connect(answers, "handle-ioctl", G_CALLBACK(&passOn), plugged.answering);
        umockdev_testbed_attach_ioctl(testbed_.get(), ("/dev/" + file).c_str(), answers, nullptr);
        fs::create_symlink(plugged.line.name(), dev_ / file);
        return *plugged.widget;
    }
    void unplug(const std::string file) {
        fs::remove(dev_ / file);
        for (const std::string& folder : plugged_.at(file).folders)
            umockdev_testbed_remove_device(testbed_.get(), folder.c_str());
        {
            const std::lock_guard lock(plugged_.at(file).answering->mutex);
            plugged_.at(file).answering->file = -1;
        }
        plugged_.at(file).widget.reset();
        plugged_.erase(file);
    }

private:
    struct Plugged {
        PseudoTerminal line;
        std::unique_ptr<Widget> widget;
        Answering* answering = nullptr;
        std::vector<std::string> folders;
    };
    // A request on a line that is gone must be answered, too, or it would wait for ever. So an
    // answering file is removed only when another replaces it, or at the end.
    void hush(const std::string& file) {
        const auto answers = answers_.find(file);
        if (answers == answers_.end()) return;
        umockdev_testbed_detach_ioctl(testbed_.get(), ("/dev/" + file).c_str(), nullptr);
        g_object_unref(answers->second);
        answers_.erase(answers);
    }
    void add(const std::string& description) {
        GError* error = nullptr;
        FANTASCOPE_CHECK(umockdev_testbed_add_from_string(testbed_.get(), description.c_str(), &error), error->message);
    }
    std::deque<Answering> answering_;  // outlives all requests
    std::unique_ptr<UMockdevTestbed, void (*)(void*)> testbed_;
    fs::path dev_;
    std::map<std::string, Plugged> plugged_;
    std::map<std::string, UMockdevIoctlBase*> answers_;  // by file, even if nothing is plugged in any more
};

class UsbWidgets : public testing::Test {
protected:
    std::unique_ptr<DmxPort> open(const std::string& keys, int universe = 1) {
        const auto node = ConfigNode::parse("driver: enttec_pro\n" + keys, "site.yaml").value();
        return drivers::openDmxPort(node, universe, context_).value();
    }
    static void await(const Device& device, DeviceState state, const std::string& detail) {
        DeviceStatus status;
        const auto isSo = [&] {
            status = device.status();
            return status.state == state && status.detail.find(detail) != std::string::npos;
        };
        SteadyClock clock;
        while (!isSo() && clock.now() < 30s) clock.sleepUntil(clock.now() + 1ms);
        ASSERT_TRUE(isSo()) << nameOf(state) << ": " << detail << " is wanted; it is " << nameOf(status.state) << ": "
                            << status.detail;
    }
    static void expectOn(Widget& widget, DmxPort& port, int number) {
        await(port, DeviceState::Running, "");
        EXPECT_TRUE(port.send(dmxFrame(number)));
        eventually("the frame", [&] { return widget.out() == dmxFrame(number); });
    }

    Machine machine_;
    SteadyClock clock_;
    drivers::DriverContext context_{clock_};
};

TEST_F(UsbWidgets, are_found_with_what_they_are_and_what_a_site_file_says) {
    machine_.plugIn(kLeft, "ttyUSB0");
    machine_.plugIn(kBare, "ttyUSB1");
    const auto found = drivers::findWidgets();
    ASSERT_THAT(found, SizeIs(2));
    EXPECT_EQ(found[0].what, "ENTTEC DMX USB PRO, firmware 1.44, number 00000001");
    EXPECT_EQ(found[0].identity, "serial EN100001");
    EXPECT_EQ(found[0].where, "/dev/ttyUSB0");
    EXPECT_EQ(found[0].options, "{driver: enttec_pro, serial: EN100001}");
    EXPECT_EQ(found[0].why, "");
    EXPECT_THAT(found[1].what, HasSubstr("an Open DMX or another serial adapter"));
    EXPECT_EQ(found[1].options, "{driver: open_dmx, serial: AB0CD1EF}");
}

TEST_F(UsbWidgets, in_use_are_found_and_left_alone) {
    Widget& widget = machine_.plugIn(kLeft, "ttyUSB0");
    const auto port = open("serial: EN100001\n");
    expectOn(widget, *port, 1);
    const auto found = drivers::findWidgets();
    ASSERT_THAT(found, SizeIs(1));
    EXPECT_THAT(found[0].why, HasSubstr("in use"));
    EXPECT_EQ(widget.out(), dmxFrame(1)) << "a widget that is asked its name stops sending";
}

TEST_F(UsbWidgets, that_do_not_answer_are_found_with_the_reason) {
    machine_.plugIn(kLeft, "ttyUSB0").fallSilent();
    const auto found = drivers::findWidgets();
    ASSERT_THAT(found, SizeIs(1));
    EXPECT_THAT(found[0].why, HasSubstr("does not answer"));
}

TEST_F(UsbWidgets, are_told_by_their_adapters_serial_number_whatever_file_they_are_given) {
    machine_.plugIn(kLeft, "ttyUSB0");
    machine_.plugIn(kRight, "ttyUSB1");
    const auto left = open("serial: EN100001\n", 1), right = open("serial: EN100002\n", 2);
    await(*left, DeviceState::Running, "");
    await(*right, DeviceState::Running, "");
    machine_.unplug("ttyUSB0");
    machine_.unplug("ttyUSB1");
    await(*left, DeviceState::Absent, "no serial adapter EN100001 is plugged in");
    await(*right, DeviceState::Absent, "no serial adapter EN100002 is plugged in");
    Widget& rightWidget = machine_.plugIn(kRight, "ttyUSB0");
    Widget& leftWidget = machine_.plugIn(kLeft, "ttyUSB7");
    expectOn(leftWidget, *left, 1);
    expectOn(rightWidget, *right, 2);
    EXPECT_EQ(leftWidget.out(), dmxFrame(1));
    EXPECT_EQ(left->status().losses, 1);
}

TEST_F(UsbWidgets, are_told_by_their_own_number_among_all_adapters) {
    machine_.plugIn(kLeft, "ttyUSB0");
    machine_.plugIn(kBare, "ttyUSB2");
    const auto port = open("number: '00000002'\n");
    await(*port, DeviceState::Absent, "not 00000002");
    Widget& widget = machine_.plugIn(kRight, "ttyUSB1");
    expectOn(widget, *port, 1);
}

TEST_F(UsbWidgets, need_no_key_where_there_is_one_and_a_serial_number_where_there_are_two) {
    Widget& widget = machine_.plugIn(kLeft, "ttyUSB0");
    machine_.plugIn(kBare, "ttyUSB1");
    auto port = open("");
    expectOn(widget, *port, 1);
    port.reset();
    machine_.plugIn(kRight, "ttyUSB2");
    port = open("");
    await(*port, DeviceState::Absent, "several DMX widgets are plugged in; choose one with 'serial': EN100001, EN100002");
    machine_.unplug("ttyUSB0");
    await(*port, DeviceState::Running, "");
    machine_.unplug("ttyUSB2");
    await(*port, DeviceState::Absent, "no DMX widget is plugged in");
}

TEST_F(UsbWidgets, hang_on_lines_that_are_found_by_any_part_of_an_identity) {
    const auto error = [](const drivers::SerialIdentity& which) { return drivers::findSerialLine(which).error().message(); };
    EXPECT_EQ(error({.file = {}, .vendor = {}, .product = {}, .serial = "X"}), "no serial adapter X is plugged in");
    machine_.plugIn(kLeft, "ttyUSB0");
    machine_.plugIn(kRight, "ttyUSB1");
    EXPECT_EQ(drivers::findSerialLine({.file = {}, .vendor = {}, .product = {}, .serial = "EN100002"}).value(), "/dev/ttyUSB1");
    EXPECT_THAT(error({.file = {}, .vendor = "0403", .product = {}, .serial = {}}),
                AllOf(HasSubstr("several"), HasSubstr("serial EN100001"), HasSubstr("serial EN100002")));
    EXPECT_THAT(error({.file = {}, .vendor = "1a86", .product = {}, .serial = {}}),
                HasSubstr("there is /dev/ttyUSB0 (ENTTEC DMX USB PRO, serial EN100001)"));
    EXPECT_EQ(drivers::findSerialLine({.file = "/dev/ttyS9", .vendor = {}, .product = {}, .serial = {}}).value(), "/dev/ttyS9");
}

std::string claimOfRelaysOn(const std::string& usb) {
    const auto node = ConfigNode::parse("driver: modbus_rtu\nusb: {" + usb + "}\n", "site.yaml").value();
    return drivers::readRelayBank(node, "relays", {true}).value().claim();
}

// Example failure: if several adapters match, nothing is claimed, and a second run takes the first
// one's relays.
TEST_F(UsbWidgets, are_claimed_as_the_lines_that_their_drivers_take) {
    const auto claim = [](const std::string& keys) {
        return drivers::readDmxPort(ConfigNode::parse(keys, "site.yaml").value(), 1).value().claim();
    };
    const std::string left = "serial line /dev/ttyUSB0", right = "serial line /dev/ttyUSB1";
    machine_.list(kLeft, "ttyUSB0");  // without a file: umockdev does not follow links that leave its machine
    EXPECT_EQ(claim("{driver: enttec_pro}"), left);
    machine_.list(kRight, "ttyUSB1");
    EXPECT_EQ(claimOfRelaysOn("vendor: '0403'"), left) << "of several the first one";
    EXPECT_EQ(claimOfRelaysOn("serial: EN100002"), right);
    EXPECT_EQ(claim("{driver: open_dmx, serial: EN100002}"), right);
    EXPECT_EQ(claim("{driver: enttec_pro}"), "the only DMX widget") << "of several none";
}

}  // namespace
}  // namespace fantascope::contract
