// The cue controller's contract on a real libusb, with umockdev devices.

#include "drivers/cue_controller/usb_hid.h"

#include "drivers/cue_controller_devices.h"
#include "drivers/registry.h"

#include "contract/cue_controller_suite.h"
#include "contract/mock_usb.h"

#include <gmock/gmock.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <functional>
#include <set>
#include <thread>
#include <utility>

namespace fantascope::contract {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsEmpty;

// Eight buttons in a byte.
const std::vector<std::uint8_t> kEightButtons = {0x05, 0x01, 0x09, 0x05, 0xa1, 0x01, 0x05, 0x09, 0x19, 0x01, 0x29, 0x08,
                                                 0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x08, 0x81, 0x02, 0xc0};

MockUsbDevice eightButtons(const std::string& path, const std::string& serial) {
    MockUsbDevice device;
    device.path = path;
    device.serial = serial;
    device.reportDescriptors = {kEightButtons};
    return device;
}

// True as soon as the condition holds; false after a time that no machine needs.
template <class Condition>
bool eventually(Condition condition) {
    SteadyClock clock;
    while (!condition()) {
        if (clock.now() > 30s) return false;
        std::this_thread::yield();
    }
    return true;
}

// A kind of device, and what its reports say.
struct Kind {
    MockUsbDevice device;
    std::function<std::vector<std::uint8_t>(const std::set<int>& down)> report;
    int lamps = 0;  // on buttons 1 to this
    // What a button shows after these reports to the device.
    std::function<ButtonLight::State(const std::vector<MockUsbReport>&, int button)> shown{};
};

class UsbHidRig final : public CueControllerRig {
public:
    explicit UsbHidRig(Kind kind) : kind_(std::move(kind)) {
        kind_.device.path = "1-1";
        kind_.device.serial = "CUE-7";
        usb_.plug(eightButtons("1-2", "other"));
        show();
        usb_.plug(kind_.device);
        neighbour_ = open("other");
        reopen();
        letTimePass();
        eventually([&] { return neighbour_->status().state == DeviceState::Running; });
    }

    CueController& port() override { return *port_; }
    void reopen() override {
        port_.reset();
        port_ = open("CUE-7");
    }
    void close() override { port_.reset(); }
    void unplug() override {
        usb_.unplug("1-1");
        isPlugged_ = false;
    }
    void plugIn() override {
        show();
        usb_.plug(kind_.device);
        // A device with buttons down reports them once somebody listens.
        if (!kind_.device.tellsState && !down_.empty()) usb_.report("1-1", 0, kind_.report(down_));
        isPlugged_ = true;
    }
    void finger(int button, bool down) override {
        if (down)
            down_.insert(button);
        else
            down_.erase(button);
        show();
        usb_.report("1-1", 0, kind_.report(down_));
    }
    void letTimePass() override {
        const bool settled = eventually([&] { return (port_->status().state == DeviceState::Running) == isPlugged_; });
        EXPECT_TRUE(settled) << port_->status().detail;
        if (!isPlugged_ || !settled) return;
        EXPECT_TRUE(eventually([&] { return usb_.isHeard("1-1"); }));
        // Its debounce time is over. A report without a change wakes it to notice that.
        clock_.sleepUntil(clock_.now() + 6ms);
        usb_.report("1-1", 0, kind_.report(down_));
        EXPECT_TRUE(eventually([&] { return usb_.isHeard("1-1"); }));
        if (kind_.lamps == 0) return;
        // All lights are shown once the last button shows a light that was set after them.
        probe_ = probe_ == ButtonLight::State::Ready ? ButtonLight::State::Active : ButtonLight::State::Ready;
        port_->light(kind_.lamps, {probe_, ""});
        EXPECT_TRUE(eventually([&] { return shown(kind_.lamps) == probe_; }));
    }
    Clock& clock() override { return clock_; }
    Device& neighbour() override { return *neighbour_; }
    ButtonLight::State shown(int button) override {
        return kind_.shown ? kind_.shown(usb_.sent("1-1"), button) : ButtonLight::State::Off;
    }
    int absentButton() const override { return 99; }

private:
    std::unique_ptr<CueController> open(const std::string& serial) {
        const auto options = ConfigNode::parse("{driver: usb_hid, serial: " + serial + "}\n", "site.yaml");
        return drivers::openCueController(options.value(), context_).value();
    }
    void show() { usb_.setState("1-1", 0, kind_.report(down_)); }

    SteadyClock clock_;
    drivers::DriverContext context_{clock_};
    MockMachine machine_;
    MockUsb usb_{machine_};
    Kind kind_;
    bool isPlugged_ = true;
    std::set<int> down_;
    ButtonLight::State probe_ = ButtonLight::State::Off;
    std::unique_ptr<CueController> port_, neighbour_;
};

std::vector<std::uint8_t> bitsOf(const std::set<int>& down) {
    unsigned bits = 0;
    for (const int button : down) bits |= 1u << (button - 1);
    return {static_cast<std::uint8_t>(bits)};
}

Kind lampless(bool tellsState) {
    Kind kind;
    kind.device = eightButtons("", "");
    kind.report = &bitsOf;
    kind.device.tellsState = tellsState;
    return kind;
}

using enum ButtonLight::State;

// P.I. Engineering's data report of the XK-24: bytes 2 to 5 are its columns of six; command 181
// lights index 0 to 29 blue, 32 to 61 red.
Kind xkeys(bool hasOutEndpoint) {
    Kind kind;
    kind.device.vendor = 0x05f3;
    kind.device.product = 0x0405;
    kind.device.reportDescriptors = {drivers::kXkeys};
    kind.device.hasOutEndpoints = hasOutEndpoint;
    kind.report = [](const std::set<int>& down) {
        std::vector<std::uint8_t> bytes(32);
        for (const int button : down)
            bytes.at(static_cast<std::size_t>(2 + (button - 1) / 6)) |= static_cast<std::uint8_t>(1 << (button - 1) % 6);
        return bytes;
    };
    kind.lamps = 24;
    kind.shown = [](const std::vector<MockUsbReport>& reports, int button) {
        std::array<int, 80> lamps{};
        for (const MockUsbReport& report : reports)
            if (report.bytes.at(0) == 181) lamps.at(report.bytes.at(1)) = report.bytes.at(2);
        const auto blue = static_cast<std::size_t>((button - 1) / 6 * 8 + (button - 1) % 6), red = blue + 32;
        if (lamps.at(red) == 1 && lamps.at(blue) == 0) return Alarm;
        return std::array{Off, Ready, Active}.at(static_cast<std::size_t>(lamps.at(blue)));
    };
    return kind;
}

// The pictures of a Stream Deck, recognised by their colour at the edge;
// https://docs.elgato.com/streamdeck/hid.
Kind streamDeck() {
    Kind kind;
    kind.device.vendor = 0x0fd9;
    kind.device.product = 0x0080;
    kind.device.reportDescriptors = {drivers::kStreamDeck};
    kind.device.hasOutEndpoints = true;
    kind.report = [](const std::set<int>& down) {
        std::vector<std::uint8_t> bytes(512);
        bytes[0] = 1;
        bytes[2] = 15;
        for (const int button : down) bytes.at(static_cast<std::size_t>(3 + button)) = 1;
        return bytes;
    };
    kind.lamps = 15;
    kind.shown = [](const std::vector<MockUsbReport>& reports, int button) {
        std::vector<std::uint8_t> file, whole;
        for (const MockUsbReport& report : reports) {
            if (report.bytes.at(0) != 2 || report.bytes.at(1) != 7 || report.bytes.at(2) != button - 1) continue;
            const std::ptrdiff_t count = report.bytes.at(4) + 256 * report.bytes.at(5);
            file.insert(file.end(), report.bytes.begin() + 8, report.bytes.begin() + 8 + count);
            if (report.bytes.at(3) == 1) whole = std::exchange(file, {});
        }
        if (whole.empty()) return Off;
        const auto pixel = cv::imdecode(whole, cv::IMREAD_COLOR).at<cv::Vec3b>(3, 3);
        const bool green = pixel[1] > 60, red = pixel[2] > 120;
        return green && red ? Active : green ? Ready : red ? Alarm : Off;
    };
    return kind;
}

TEST(CueControllerContract, is_kept_by_usb_hid) {
    EXPECT_THAT(violations(cueControllerSuite(), [] { return std::make_unique<UsbHidRig>(lampless(true)); }), IsEmpty());
}

// Many devices cannot report what is pressed now.
TEST(CueControllerContract, is_kept_by_usb_hid_with_a_device_that_tells_only_changes) {
    EXPECT_THAT(violations(cueControllerSuite(), [] { return std::make_unique<UsbHidRig>(lampless(false)); }), IsEmpty());
}

TEST(CueControllerContract, of_lamps_is_kept_by_usb_hid_with_a_panel_of_two_colours) {
    EXPECT_THAT(violations(lampSuite(), [] { return std::make_unique<UsbHidRig>(xkeys(true)); }), IsEmpty());
}

// Some devices have no endpoint for output reports.
TEST(CueControllerContract, of_lamps_is_kept_by_usb_hid_over_the_control_pipe) {
    EXPECT_THAT(violations(lampSuite(), [] { return std::make_unique<UsbHidRig>(xkeys(false)); }), IsEmpty());
}

TEST(CueControllerContract, of_lamps_is_kept_by_usb_hid_with_pictures_on_keys) {
    EXPECT_THAT(violations(lampSuite(), [] { return std::make_unique<UsbHidRig>(streamDeck()); }), IsEmpty());
}

class UsbHidTest : public testing::Test {
protected:
    std::unique_ptr<CueController> open(const std::string& keys) {
        const auto options = ConfigNode::parse("{driver: usb_hid, debounce: 0" + keys + "}\n", "site.yaml").value();
        return drivers::openCueController(options, context_).value();
    }
    static bool isRunning(const Device& device) { return device.status().state == DeviceState::Running; }
    // "+3" for button 3 down, once all reports have arrived.
    std::string given(CueController& controller, const std::string& path = "1-1") {
        EXPECT_TRUE(eventually([&] { return usb_.isHeard(path); }));
        std::string events;
        while (const auto event = controller.poll()) events += fmt::format("{}{}", event->pressed ? '+' : '-', event->button);
        return events;
    }

    SteadyClock clock_;
    drivers::DriverContext context_{clock_};
    MockMachine machine_;
    MockUsb usb_{machine_};
};

// Two sites may describe one controller differently.
TEST_F(UsbHidTest, is_claimed_by_where_it_is_plugged_in) {
    const auto claim = [](const std::string& keys) {
        return drivers::readCueController(ConfigNode::parse("{driver: usb_hid" + keys + "}\n", "site.yaml").value())
            .value()
            .claim();
    };
    EXPECT_EQ(claim(", serial: P"), "cue controller with serial P");
    usb_.plug(eightButtons("1-1", "P"));
    usb_.plug(eightButtons("1-2", "Q"));
    for (const char* keys : {", serial: P", ", path: 1-1", ", vendor: 16c0"})
        EXPECT_EQ(claim(keys), "cue controller at the USB port 1-1") << keys;
    EXPECT_EQ(claim(", serial: Q"), "cue controller at the USB port 1-2");
    const auto controller = open(", serial: P");
    ASSERT_TRUE(eventually([&] { return isRunning(*controller); })) << controller->status().detail;
    EXPECT_EQ(claim(", serial: P"), "cue controller at the USB port 1-1") << "and it goes on";
    usb_.report("1-1", 0, {0x01});
    EXPECT_EQ(given(*controller), "+1");
}

// The operator's keys reach no other program while the show has them, and all programs again when
// it ends.
TEST_F(UsbHidTest, takes_every_interface_from_the_kernel_and_gives_it_back) {
    MockUsbDevice presenter = eightButtons("1-1", "P");
    presenter.reportDescriptors = {kEightButtons, kEightButtons, kEightButtons};
    usb_.plug(presenter);
    auto controller = open(", serial: P");
    ASSERT_TRUE(eventually([&] { return isRunning(*controller); })) << controller->status().detail;
    for (int interface = 0; interface < 3; ++interface) {
        EXPECT_FALSE(usb_.kernelHas("1-1", interface));
        EXPECT_GT(usb_.waiting("1-1", interface), 1u) << "one report may follow another at once";
    }
    usb_.report("1-1", 2, {0x01});
    usb_.report("1-1", 1, {0x80});
    usb_.report("1-1", 0, {0x02});
    usb_.report("1-1", 2, {0x00});
    EXPECT_EQ(given(*controller), "+17+16+2-17");
    controller.reset();
    for (int interface = 0; interface < 3; ++interface) EXPECT_TRUE(usb_.kernelHas("1-1", interface));
}

// Example failure: somebody sat on the clicker before the doors opened; its report waits in the
// device, and the show begins with a GO.
TEST_F(UsbHidTest, a_report_from_before_is_no_press) {
    MockUsbDevice device = eightButtons("1-1", "P");
    device.tellsState = false;
    usb_.plug(device);
    usb_.report("1-1", 0, {0x01});
    usb_.report("1-1", 0, {0x00});
    usb_.report("1-1", 0, {0x02});
    const auto controller = open(", serial: P");
    ASSERT_TRUE(eventually([&] { return isRunning(*controller); })) << controller->status().detail;
    usb_.report("1-1", 0, {0x00});
    usb_.report("1-1", 0, {0x03});
    EXPECT_EQ(given(*controller), "+1+2");
}

// Example failure: somebody presses a button as the show ends, and the program never ends.
TEST_F(UsbHidTest, ends_though_a_report_comes_just_before_its_transfer_is_cancelled) {
    usb_.plug(eightButtons("1-1", "P"));
    auto controller = open(", serial: P");
    ASSERT_TRUE(eventually([&] { return isRunning(*controller); })) << controller->status().detail;
    usb_.reportAtCancel("1-1", 0, {0x01});
    controller.reset();
    EXPECT_TRUE(usb_.kernelHas("1-1", 0));
    EXPECT_EQ(usb_.waiting("1-1", 0), 0u);
}

TEST_F(UsbHidTest, thousands_of_reports_come_in_their_order_and_none_is_lost) {
    usb_.plug(eightButtons("1-1", "P"));
    const auto controller = open(", serial: P");
    ASSERT_TRUE(eventually([&] { return isRunning(*controller); })) << controller->status().detail;
    Time last{};
    for (int press = 0; press < 1000; ++press) {
        for (const std::uint8_t state : {1 << press % 8, 0}) usb_.report("1-1", 0, {state});
        for (const bool pressed : {true, false}) {
            std::optional<ButtonEvent> event;
            ASSERT_TRUE(eventually([&] { return (event = controller->poll()).has_value(); })) << press;
            EXPECT_EQ(event->button, press % 8 + 1);
            EXPECT_EQ(event->pressed, pressed);
            EXPECT_GE(event->at, last);
            last = event->at;
        }
    }
    EXPECT_EQ(given(*controller), "");
}

TEST_F(UsbHidTest, an_endpoint_that_stops_or_errs_goes_on) {
    usb_.plug(eightButtons("1-1", "P"));
    const auto controller = open(", serial: P");
    ASSERT_TRUE(eventually([&] { return isRunning(*controller); })) << controller->status().detail;
    for (int time = 0; time < 20; ++time) {
        time % 2 == 0 ? usb_.stall("1-1", 0) : usb_.fail("1-1", 0);
        usb_.report("1-1", 0, {0x01});
        usb_.report("1-1", 0, {0x00});
        EXPECT_EQ(given(*controller), "+1-1");
    }
    EXPECT_EQ(controller->status().losses, 0);
}

TEST_F(UsbHidTest, a_cable_that_only_errs_is_a_fault_and_is_tried_again) {
    usb_.plug(eightButtons("1-1", "P"));
    const auto controller = open(", serial: P");
    ASSERT_TRUE(eventually([&] { return isRunning(*controller); })) << controller->status().detail;
    usb_.report("1-1", 0, {0x01});
    EXPECT_EQ(given(*controller), "+1");
    ASSERT_TRUE(eventually([&] {
        if (controller->status().losses == 0 && usb_.waiting("1-1", 0) > 0) usb_.fail("1-1", 0);
        return controller->status().losses == 1;
    }));
    EXPECT_EQ(given(*controller), "-1");
    EXPECT_TRUE(eventually([&] { return isRunning(*controller); }));
}

// The bytes are from the device's data report, not from the program.
TEST_F(UsbHidTest, lights_a_stick_by_its_endpoint_and_darkens_it_at_the_end) {
    MockUsbDevice stick = xkeys(true).device;
    stick.product = 1049;
    usb_.plug(stick);
    auto controller = open(", vendor: 05f3, brightness: 1");
    const auto report = [](std::vector<std::uint8_t> bytes) {
        bytes.resize(35);
        return bytes;
    };
    const auto sent = [&] {
        std::vector<std::vector<std::uint8_t>> bytes;
        for (const MockUsbReport& each : usb_.sent("1-1")) {
            EXPECT_TRUE(each.byEndpoint);
            EXPECT_EQ(each.interface, 0);
            bytes.push_back(each.bytes);
        }
        return bytes;
    };
    controller->light(7, {Ready, "GO"});
    // Its intensity, and sixteen lamps.
    ASSERT_TRUE(eventually([&] { return sent().size() >= 17; })) << controller->status().detail;
    EXPECT_EQ(sent()[0], report({187, 255, 0}));
    EXPECT_THAT(sent(), testing::Contains(report({181, 8, 1, 1}))) << "the seventh begins the second column";
    controller->light(7, {Ready, "GO"});
    controller->light(1, {Active, ""});
    ASSERT_TRUE(eventually([&] { return sent().size() >= 18; }));
    EXPECT_EQ(sent().back(), report({181, 0, 2, 1}));
    controller.reset();
    ASSERT_EQ(sent().size(), 20u) << "what was told twice was sent once";
    EXPECT_EQ(sent()[18], report({181, 0, 0, 1}));
    EXPECT_EQ(sent()[19], report({181, 8, 0, 1}));
}

TEST_F(UsbHidTest, lights_the_lamps_of_a_number_pad_over_the_control_pipe) {
    MockUsbDevice pad;
    pad.serial = "N";
    pad.reportDescriptors = {kEightButtons, drivers::kBootKeyboard};
    usb_.plug(pad);
    auto controller = open(", serial: N, profile: number_pad");
    controller->light(2, {Ready, "BACK"});
    ASSERT_TRUE(eventually([&] { return !usb_.sent("1-1").empty() && usb_.sent("1-1").back().bytes.at(0) == 2; }))
        << controller->status().detail;
    const MockUsbReport report = usb_.sent("1-1").back();
    EXPECT_EQ(report.interface, 1);
    EXPECT_FALSE(report.byEndpoint);
    EXPECT_FALSE(report.feature);
    EXPECT_EQ(report.id, 0);
    EXPECT_THAT(report.bytes, testing::ElementsAre(2)) << "Caps Lock";
    controller.reset();
    EXPECT_THAT(usb_.sent("1-1").back().bytes, testing::ElementsAre(0));
}

TEST_F(UsbHidTest, says_how_bright_a_key_pad_is_in_a_feature_report) {
    usb_.plug(streamDeck().device);
    const auto controller = open(", vendor: 0fd9, brightness: 0.25");
    ASSERT_TRUE(eventually([&] { return usb_.sent("1-1").size() >= 2; })) << controller->status().detail;
    const auto sent = usb_.sent("1-1");
    EXPECT_TRUE(sent[0].byEndpoint);
    EXPECT_EQ(sent[0].bytes.size(), 1024u);
    EXPECT_EQ(sent[1].feature, true);
    EXPECT_EQ(sent[1].byEndpoint, false);
    EXPECT_EQ(sent[1].id, 3);
    std::vector<std::uint8_t> brightness = {3, 8, 25};
    brightness.resize(32);
    EXPECT_EQ(sent[1].bytes, brightness);
}

// Example failure: the operator presses GO while the pad is busy with its pictures, and nothing
// happens.
TEST_F(UsbHidTest, a_device_that_takes_no_lights_for_a_while_serves_and_shows_the_newest_then) {
    const Kind kind = xkeys(true);
    usb_.plug(kind.device);
    const auto controller = open(", vendor: 05f3");
    ASSERT_TRUE(eventually([&] { return isRunning(*controller) && usb_.sent("1-1").size() >= 49; }));
    for (const MockUsb::Taking taking : {MockUsb::Taking::Nothing, MockUsb::Taking::Stalls}) {
        usb_.take("1-1", taking);
        controller->light(1, {Alarm, ""});
        controller->light(2, {Alarm, ""});
        usb_.report("1-1", 0, kind.report({5}));
        usb_.report("1-1", 0, kind.report({}));
        EXPECT_EQ(given(*controller), "+5-5");
        controller->light(1, {Ready, ""});
        controller->light(2, {Off, ""});
        usb_.take("1-1", MockUsb::Taking::All);
        const auto shows = [&](int button, ButtonLight::State state) { return kind.shown(usb_.sent("1-1"), button) == state; };
        EXPECT_TRUE(eventually([&] { return shows(1, Ready) && shows(2, Off); }));
    }
    EXPECT_EQ(controller->status().losses, 0);
}

// Example failure: the pad stays dark for the rest of the night, and nobody is told why.
TEST_F(UsbHidTest, a_device_that_takes_no_lights_any_more_serves_and_says_so) {
    const Kind kind = xkeys(true);
    usb_.plug(kind.device);
    const auto controller = open(", vendor: 05f3");
    ASSERT_TRUE(eventually([&] { return isRunning(*controller) && usb_.sent("1-1").size() >= 49; }));
    EXPECT_EQ(controller->status().trouble, "");
    usb_.take("1-1", MockUsb::Taking::Stalls);
    controller->light(1, {Alarm, ""});
    EXPECT_TRUE(eventually([&] { return controller->status().trouble.starts_with("it refuses lights"); }));
    usb_.report("1-1", 0, kind.report({5}));
    usb_.report("1-1", 0, kind.report({}));
    EXPECT_EQ(given(*controller), "+5-5");
    EXPECT_TRUE(isRunning(*controller));
}

TEST_F(UsbHidTest, ends_with_a_device_that_accepts_no_last_lights) {
    const Kind kind = xkeys(true);
    usb_.plug(kind.device);
    auto controller = open(", vendor: 05f3");
    controller->light(1, {Alarm, ""});
    ASSERT_TRUE(eventually([&] { return kind.shown(usb_.sent("1-1"), 1) == Alarm; }));
    usb_.take("1-1", MockUsb::Taking::Nothing);
    controller->light(2, {Ready, ""});
    controller.reset();
    EXPECT_TRUE(usb_.kernelHas("1-1", 0));
}

TEST_F(UsbHidTest, is_found_by_what_is_said_of_it_and_by_nothing_else) {
    for (const char* const keys :
         {", vendor: 16c0", ", product: 27D9", ", path: 1-1", ", vendor: 16c0, product: 27d9, serial: P, path: 1-1"}) {
        usb_.plug(eightButtons("1-1", "P"));
        const auto controller = open(keys);
        EXPECT_TRUE(eventually([&] { return isRunning(*controller); })) << keys << ": " << controller->status().detail;
        usb_.unplug("1-1");
    }
    usb_.plug(eightButtons("1-1", "P"));
    for (const char* const keys : {"", ", vendor: 16c1", ", serial: Q", ", vendor: 16c0, path: 1-2"}) {
        const auto controller = open(keys);
        EXPECT_TRUE(eventually([&] { return controller->status().state == DeviceState::Absent; })) << keys;
        EXPECT_THAT(controller->status().detail, HasSubstr("is plugged in")) << keys;
    }
}

// The machine's keyboard is never used without being named; a presenter is known.
TEST_F(UsbHidTest, is_a_known_controller_where_nothing_is_said) {
    usb_.plug(eightButtons("1-1", "keyboard"));
    MockUsbDevice shuttle;
    shuttle.path = "1-2";
    shuttle.vendor = 0x0b33;
    shuttle.product = 0x0020;
    shuttle.reportDescriptors = {kEightButtons};
    const auto controller = open("");
    EXPECT_TRUE(eventually([&] { return controller->status().state == DeviceState::Absent; }));
    usb_.plug(shuttle);
    ASSERT_TRUE(eventually([&] { return isRunning(*controller); })) << controller->status().detail;
    EXPECT_TRUE(usb_.kernelHas("1-1", 0));
    usb_.report("1-2", 0, {0, 0, 0, 0x10, 0});
    usb_.report("1-2", 0, {0, 1, 0, 0x00, 0});
    usb_.report("1-2", 0, {0, 2, 0, 0x00, 0});
    EXPECT_EQ(given(*controller, "1-2"), "+1-1+6-6+6-6");
}

TEST_F(UsbHidTest, two_of_a_kind_serve_two_controllers) {
    usb_.plug(eightButtons("1-1", ""));
    usb_.plug(eightButtons("1-2", ""));
    const auto left = open(", vendor: 16c0, path: 1-1"), right = open(", vendor: 16c0, path: 1-2");
    ASSERT_TRUE(eventually([&] { return isRunning(*left) && isRunning(*right); }));
    usb_.report("1-2", 0, {0x04});
    EXPECT_EQ(given(*right, "1-2"), "+3");
    EXPECT_EQ(given(*left), "");
}

TEST_F(UsbHidTest, says_what_is_wrong_with_a_device_that_cannot_serve) {
    MockUsbDevice garbage = eightButtons("1-1", "G");
    garbage.reportDescriptors = {{0x05, 0x01, 0x26, 0xff}};
    usb_.plug(garbage);
    const auto controller = open(", serial: G");
    EXPECT_TRUE(eventually([&] { return controller->status().state == DeviceState::Faulted; }));
    EXPECT_THAT(controller->status().detail,
                HasSubstr("it has no usable buttons: interface 0: report descriptor, byte 2: it ends inside an item"));
}

// Root may open everything, so this test runs as nobody.
class Nobody {
public:
    Nobody() { [[maybe_unused]] const int error = setresuid(65534, 65534, 0); }
    ~Nobody() { [[maybe_unused]] const int error = setresuid(0, 0, 0); }
};

TEST_F(UsbHidTest, without_permission_says_what_to_install) {
    usb_.plug(eightButtons("1-1", "P"));
    usb_.forbid("1-1");
    std::optional<Nobody> nobody;
    if (geteuid() == 0) nobody.emplace();
    const auto controller = open(", serial: P");
    EXPECT_TRUE(eventually([&] { return controller->status().state == DeviceState::Faulted; }));
    EXPECT_THAT(controller->status().detail, HasSubstr("no permission for /dev/bus/usb/001/002"));
    EXPECT_THAT(controller->status().detail, HasSubstr("systemd/70-fantascope.rules"));
    const auto found = drivers::findControllers();
    ASSERT_THAT(found, testing::SizeIs(1));
    EXPECT_THAT(found[0].why, HasSubstr("no permission"));
}

TEST_F(UsbHidTest, finds_what_is_there_without_touching_it) {
    usb_.plug(eightButtons("1-1", "P 1"));
    MockUsbDevice presenter = eightButtons("1-2", "");
    presenter.vendor = 0x0fd9;
    presenter.product = 0x0080;
    usb_.plug(presenter);
    const auto found = drivers::findControllers();
    ASSERT_THAT(found, testing::SizeIs(2));
    EXPECT_EQ(found[0].family, "cue_controller");
    EXPECT_EQ(found[0].what, "Lumen Hand Cue Controller, 8 buttons");
    EXPECT_EQ(found[0].identity, "16c0:27d9, serial P 1");
    EXPECT_EQ(found[0].where, "1-1");
    EXPECT_EQ(found[0].why, "");
    EXPECT_EQ(found[1].what, "Elgato Stream Deck, 15 buttons");
    EXPECT_TRUE(usb_.kernelHas("1-1", 0));
    // The offered options are valid in a site file.
    for (const auto& each : found) {
        const auto options = ConfigNode::parse(each.options + "\n", "site.yaml");
        ASSERT_TRUE(options) << each.options;
        const auto controller = drivers::openCueController(options.value(), context_);
        ASSERT_TRUE(controller) << controller.error().message();
        EXPECT_TRUE(eventually([&] { return isRunning(**controller); })) << (*controller)->status().detail;
    }
}

TEST_F(UsbHidTest, refuses_wrong_keys_with_their_place) {
    const auto refusal = [&](const std::string& keys) {
        const auto options = ConfigNode::parse("{driver: usb_hid, " + keys + "}\n", "site.yaml").value();
        const auto opened = drivers::openCueController(options, context_);
        return opened ? "" : opened.error().message();
    };
    EXPECT_THAT(refusal("vendor: 46d"), HasSubstr("site.yaml:1:27: vendor: '46d' is not four hexadecimal digits, such as 046d"));
    EXPECT_THAT(refusal("vendor: 0x46d"), HasSubstr("four hexadecimal digits"));
    EXPECT_THAT(refusal("profile: joystick"), HasSubstr("presenter"));
    EXPECT_THAT(refusal("debounce: -1"), HasSubstr("debounce"));
    EXPECT_THAT(refusal("brightness: 2"), HasSubstr("brightness"));
    EXPECT_THAT(refusal("debounse: 1"), HasSubstr("did you mean 'debounce'"));
}

}  // namespace
}  // namespace fantascope::contract
