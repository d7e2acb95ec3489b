// The hand controller's driver against the kernel's own USB, down to its hot-plug and its HID
// driver. The device is the kernel's gadget; tests/vm/usb_hid.sh brings it up, on a machine of its
// own; elsewhere every test here is skipped.

#include "drivers/cue_controller/usb_hid.h"

#include "drivers/common/file_handle.h"

#include "contract/cue_controller_suite.h"
#include "contract/eventually.h"
#include "core/random.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <cerrno>
#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace fantascope::drivers {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::SizeIs;

const fs::path kGadgets = "/sys/kernel/config/usb_gadget";

// One of the kernel's gadgets, to be plugged into a port of this machine, and its own end.
class Gadget {
public:
    Gadget(const std::string& name, int number, std::string serial) : name_(name), number_(number), serial_(std::move(serial)) {}
    ~Gadget() {
        if (isIn()) unplug();
    }
    void plugIn() {
        std::ofstream(kGadgets / name_ / "UDC") << fmt::format("dummy_udc.{}", number_) << std::flush;
        contract::eventually("the gadget has its file", [&] {
            end_ = FileHandle(::open(fmt::format("/dev/hidg{}", number_).c_str(), O_WRONLY | O_CLOEXEC));
            return end_.isOpen();
        });
        contract::eventually("the kernel's driver has it", [&] { return !holder().empty(); });
    }
    void unplug() {
        end_ = FileHandle();
        std::ofstream(kGadgets / name_ / "UDC") << "\n" << std::flush;
        contract::eventually("it is gone", [&] { return holder().empty(); });
    }
    bool isIn() const { return end_.isOpen(); }
    void report(std::uint8_t state) { ASSERT_EQ(write(end_.get(), &state, 1), 1) << systemMessage(errno); }
    // Who has its interface: "usbhid"; "" while it is not there.
    std::string holder() const {
        for (const auto& entry : fs::directory_iterator("/sys/bus/usb/devices")) {
            std::ifstream file(entry.path() / "serial");
            std::string serial;
            file >> serial;
            std::error_code none;
            if (serial == serial_)
                return fs::read_symlink(entry.path() / (entry.path().filename().string() + ":1.0") / "driver", none)
                    .filename()
                    .string();
        }
        return "";
    }

private:
    const std::string name_;
    const int number_;
    const std::string serial_;
    FileHandle end_;
};

std::unique_ptr<CueController> opened(const std::string& keys, const DriverContext& context) {
    const auto options = ConfigNode::parse("{driver: usb_hid, vendor: 16c0, product: 27d9" + keys + "}\n", "site.yaml").value();
    return UsbHidController::fromConfig(options).value().open(context).value();
}

class UsbHidOnTheKernel : public testing::Test {
protected:
    void SetUp() override {
        if (!fs::exists(kGadgets / "cue")) GTEST_SKIP() << "no gadget here: tests/vm/usb_hid.sh makes it";
        plug();
    }
    void TearDown() override { controller_.reset(); }

    void plug() { gadget_.plugIn(); }
    void unplug() { gadget_.unplug(); }
    void report(std::uint8_t state) { gadget_.report(state); }
    std::string holder() const { return gadget_.holder(); }
    void open(const std::string& keys) { controller_ = opened(keys, context_); }

    // Whether something becomes so; a machine in software takes its time.
    bool becomes(const std::function<bool()>& so) {
        const Time deadline = clock_.now() + std::chrono::seconds(60);
        while (!so()) {
            if (clock_.now() >= deadline) return false;
            clock_.sleepUntil(clock_.now() + std::chrono::milliseconds(1));
        }
        return true;
    }
    bool comesToBe(DeviceState state) {
        return becomes([&] { return controller_->status().state == state; });
    }
    // "+3" for button 3 down, once there are so many.
    std::string given(int count) {
        std::string events;
        EXPECT_TRUE(becomes([&] {
            while (const auto event = controller_->poll()) {
                events += fmt::format("{}{}", event->pressed ? '+' : '-', event->button);
                --count;
            }
            return count <= 0;
        })) << events;
        return events;
    }
    SteadyClock clock_;
    DriverContext context_{clock_};
    Gadget gadget_{"cue", 0, "CUE-7"};
    std::unique_ptr<CueController> controller_;
};

TEST_F(UsbHidOnTheKernel, takes_the_device_from_the_kernel_and_gives_it_back) {
    ASSERT_TRUE(becomes([&] { return holder() == "usbhid"; })) << holder();
    std::vector<FoundDevice> found;
    // The driver has it a moment before it shows what it reads.
    EXPECT_TRUE(becomes([&] {
        found = findControllers();
        return found.size() == 1 && found[0].what == "Lumen Hand Cue Controller, 8 buttons";
    }));
    ASSERT_THAT(found, SizeIs(1));
    EXPECT_EQ(found[0].identity, "16c0:27d9, serial CUE-7");
    open(", serial: CUE-7");
    ASSERT_TRUE(comesToBe(DeviceState::Running)) << controller_->status().detail;
    EXPECT_EQ(holder(), "usbfs");
    EXPECT_THAT(findControllers().at(0).why, HasSubstr("another program"));
    controller_.reset();
    EXPECT_TRUE(becomes([&] { return holder() == "usbhid"; })) << holder();
}

TEST_F(UsbHidOnTheKernel, a_report_from_before_is_no_press) {
    report(0x01);  // it waits in the device
    open("");
    ASSERT_TRUE(comesToBe(DeviceState::Running)) << controller_->status().detail;
    report(0x00);
    report(0x02);
    EXPECT_EQ(given(1), "+2");
}

// The rhythm of an impatient operator who trips over the cable, for hours. What was reported while
// it was plugged in comes, in its order, and nothing else.
TEST_F(UsbHidOnTheKernel, ten_thousand_presses_come_through_and_none_is_invented) {
    open(", debounce: 0");
    Rng rng(10'000);
    constexpr int kLives = 20, kPresses = 500;
    for (int life = 0; life < kLives; ++life) {
        ASSERT_TRUE(comesToBe(DeviceState::Running)) << controller_->status().detail;
        EXPECT_EQ(controller_->status().losses, life);
        std::string reported, events;
        for (int press = 0; press < kPresses; ++press) {
            const auto button = rng.below(8);
            for (const std::uint8_t state : {1u << button, 0u}) {
                clock_.sleepUntil(clock_.now() + fromSeconds(rng.below(4) == 0 ? 0 : rng.uniform(0, 0.003)));
                report(state);
            }
            reported += fmt::format("+{0}-{0}", button + 1);
        }
        EXPECT_EQ(given(2 * kPresses), reported);
        const auto held = rng.below(8);
        report(static_cast<std::uint8_t>(1u << held));
        EXPECT_EQ(given(1), fmt::format("+{}", held + 1));
        unplug();
        ASSERT_TRUE(comesToBe(DeviceState::Absent)) << controller_->status().detail;
        EXPECT_EQ(given(1), fmt::format("-{}", held + 1));
        plug();
    }
    ASSERT_TRUE(comesToBe(DeviceState::Running)) << controller_->status().detail;
    EXPECT_FALSE(controller_->poll());
}

// What the device at the other end of the kernel's USB was told, and not what the program meant to
// tell it.
TEST_F(UsbHidOnTheKernel, lights_the_lamps_of_a_device_again_after_a_loss_and_darkens_them_at_the_end) {
    const auto lampsBecome = [&](std::uint8_t wanted) {
        const FileHandle told(::open("/dev/hidg0", O_RDONLY | O_NONBLOCK | O_CLOEXEC));
        std::uint8_t lamps = 0xff;
        return becomes([&] {
            while (read(told.get(), &lamps, 1) == 1 && lamps != wanted) {
            }
            return lamps == wanted;
        });
    };
    open(", serial: CUE-7, profile: lamps_by_descriptor");
    controller_->light(2, {ButtonLight::State::Ready, "BACK"});
    EXPECT_TRUE(lampsBecome(0x02));
    controller_->light(1, {ButtonLight::State::Active, "GO"});
    EXPECT_TRUE(lampsBecome(0x03));
    ASSERT_TRUE(comesToBe(DeviceState::Running)) << controller_->status().detail;
    unplug();
    ASSERT_TRUE(comesToBe(DeviceState::Absent)) << controller_->status().detail;
    controller_->light(2, {ButtonLight::State::Off, "BACK"});
    plug();
    EXPECT_TRUE(lampsBecome(0x01));
    ASSERT_TRUE(comesToBe(DeviceState::Running)) << controller_->status().detail;
    controller_.reset();
    EXPECT_TRUE(lampsBecome(0x00));
}

// Gives what the port gives, but the presses of the rig's own button, by which it sees how far the
// port has come.
class Marked final : public CueController {
public:
    static constexpr int kMark = 8;
    explicit Marked(std::unique_ptr<CueController> controller) : controller_(std::move(controller)) {}
    DeviceStatus status() const override { return controller_->status(); }
    void light(int button, const ButtonLight& light) override { controller_->light(button, light); }
    std::optional<ButtonEvent> poll() override {
        advance();
        if (taken_.empty()) return std::nullopt;
        const ButtonEvent oldest = taken_.front();
        taken_.pop_front();
        return oldest;
    }
    // Whether a mark has come and gone since the last time.
    bool advance() {
        bool marked = false;
        while (const auto event = controller_->poll()) {
            if (event->button == kMark)
                marked = marked || !event->pressed;
            else
                taken_.push_back(*event);
        }
        return marked;
    }

private:
    const std::unique_ptr<CueController> controller_;
    std::deque<ButtonEvent> taken_;
};

class GadgetRig final : public contract::LamplessRig {
public:
    GadgetRig() {
        for (Gadget* gadget : {&gadget_, &next_}) gadget->plugIn();
        neighbour_ = opened(", serial: CUE-8", context_);
        reopen();
        letTimePass();
    }

    CueController& port() override { return *port_; }
    void reopen() override {
        port_.reset();
        port_ = std::make_unique<Marked>(opened(", serial: CUE-7", context_));
    }
    void close() override { port_.reset(); }
    void unplug() override { gadget_.unplug(); }
    // The kernel's gadget tells of no button that is down already until something changes.
    void plugIn() override {
        gadget_.plugIn();
        told_ = 0;
    }
    void finger(int button, bool down) override {
        const auto bit = static_cast<std::uint8_t>(1u << (button - 1));
        down_ = static_cast<std::uint8_t>(down ? down_ | bit : down_ & ~bit);
        if (gadget_.isIn()) gadget_.report(told_ = down_);
    }
    // A mark in the first moment of a device's life is taken for one from before, so there may have
    // to be several.
    void letTimePass() override {
        contract::eventually("the port is as it was plugged", [&] { return runs(*port_) == gadget_.isIn(); });
        if (!gadget_.isIn()) return;
        contract::eventually("a mark", [&] {
            gadget_.report(static_cast<std::uint8_t>(told_ | 1u << (Marked::kMark - 1)));
            gadget_.report(told_);
            const Time soon = clock_.now() + std::chrono::milliseconds(200);
            while (clock_.now() < soon)
                if (port_->advance()) return true;
            return false;
        });
    }
    Clock& clock() override { return clock_; }
    Device& neighbour() override {
        contract::eventually("the neighbour runs", [&] { return runs(*neighbour_); });
        return *neighbour_;
    }
    int absentButton() const override { return 99; }

private:
    static bool runs(const Device& device) { return device.status().state == DeviceState::Running; }

    SteadyClock clock_;
    DriverContext context_{clock_};
    Gadget gadget_{"cue", 0, "CUE-7"}, next_{"neighbour", 1, "CUE-8"};
    std::uint8_t down_ = 0, told_ = 0;  // a bit a button
    std::unique_ptr<CueController> neighbour_;
    std::unique_ptr<Marked> port_;
};

TEST(UsbHidContractOnTheKernel, is_kept) {
    if (!fs::exists(kGadgets / "cue")) GTEST_SKIP() << "no gadget here: tests/vm/usb_hid.sh makes it";
    EXPECT_THAT(contract::violations(contract::cueControllerSuite(), [] { return std::make_unique<GadgetRig>(); }),
                testing::IsEmpty());
}

}  // namespace
}  // namespace fantascope::drivers
