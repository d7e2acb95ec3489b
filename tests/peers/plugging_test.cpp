// A day of plugging at the real drivers: `fantascope run` with widgets on serial lines, lamps on
// two networks, a desk, relays, contacts, a hand controller and a camera. Each is unplugged and
// replugged over and over, in random order, while the show runs.

#include "contract/mock_usb.h"
#include "contract/projectors.h"
#include "contract/widget_socket.h"
#include "core/check.h"
#include "core/clock.h"
#include "core/random.h"
#include "edid_block.h"
#include "mock_camera.h"
#include "peers/modbus_peer.h"
#include "peers/own_network.h"
#include "running_program.h"
#include "scratch_folder.h"
#include "test_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <set>
#include <string_view>

namespace fantascope::peers {
namespace {

#ifdef FANTASCOPE_SANITIZED
constexpr int kTimes = 10;  // everything is slower, and the sanitizer finds what counts
#else
constexpr int kTimes = 100;
#endif

constexpr std::string_view kShow = R"(fantascope: show
version: 1
title: Plugging
sources:
  red: {solid: [1, 0, 0]}
  seen: {camera: {}}
looks:
  one: {outputs: {left: [{source: red}], right: [{source: seen}]}, fixtures: {spot: 1, wash: .4, far: .2}, relays: {road: off}}
  two: {outputs: {left: [{source: seen}], right: [{source: red}]}, fixtures: {spot: .2, wash: 1, far: .4}, relays: {road: on}}
cues: [{name: One, look: one, fade: 0.1}, {name: Two, look: two, fade: 0.1}]
)";

// What is unplugged together, and the devices that go with it.
struct Plug {
    std::vector<std::string> devices;
    std::function<void(bool in)> put;
    bool in = true;
    int pulls = 0;
};

class Plugging : public testing::Test {
protected:
    void SetUp() override {
        if (!whyNoNetwork().empty()) GTEST_SKIP() << whyNoNetwork();
        if (const std::string missing = ModbusPeer::missing(); !missing.empty()) GTEST_SKIP() << missing;
        relays_.emplace(ModbusPeer::Wire::Tcp, 1);
        contacts_.emplace(ModbusPeer::Wire::Rtu, 1);
        hand_.reportDescriptors = {{0x05, 0x01, 0x09, 0x05, 0xa1, 0x01, 0x05, 0x09, 0x19, 0x01, 0x29, 0x08,
                                    0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x08, 0x81, 0x02, 0xc0}};
        usb_.setState(hand_.path, 0, {0});
        usb_.plug(hand_);
        camera_.plugIn(0);
        auto projectors = Projectors::start();
        ASSERT_TRUE(projectors) << projectors.error().message();
        projectors_ = std::move(projectors).value();
        projectors_->switchOn("DUMMY1", {Projectors::kSize.x, 0});
        projectors_->plug("DUMMY1", kEdid);
        plugs_ = {
            {{"left"},
             [this](bool in) {
                 in ? projectors_->switchOn("DUMMY1", {Projectors::kSize.x, 0}) : projectors_->switchOff("DUMMY1");
             }},
            {{"universe 1"}, [this](bool in) { in ? widget_.plugIn() : widget_.unplug(); }},
            {{"universe 2", "desk 1"}, [](bool in) { setLink("far", in); }},
            {{"universe 3"}, [](bool in) { setLink("apart", in); }},
            {{"street"}, [this](bool in) { relays_->ask(in ? "mend 0" : "cut 0"); }},
            {{"doors"}, [this](bool in) { contacts_->ask(in ? "mend 0" : "cut 0"); }},
            {{"cue controller"}, [this](bool in) { in ? usb_.plug(hand_) : usb_.unplug(hand_.path); }},
            {{"camera"}, [this](bool in) { in ? camera_.plugIn(++node_) : camera_.unplug(); }},
        };
        folder_.file("show.yaml", std::string(kShow));
        folder_.file("site.yaml", site());
    }
    void TearDown() override {
        for (const char* link : {"far", "apart"}) setLink(link, true);
    }

    std::string site() const {
        const auto inside = [](std::string options) {  // joins a map's lines to one
            std::replace(options.begin(), options.end(), '\n', ',');
            return "{" + options + "}";
        };
        return fmt::format(R"(fantascope: site
version: 1
outputs:
  - {{name: left, display: {{driver: glfw, monitor: {{serial: LEFT}}}}, size: [320, 180], refresh_rate: 60}}
  - {{name: right, display: {{driver: headless}}, size: [64, 36], refresh_rate: 30}}
universes:
  - {{number: 1, port: {{driver: enttec_pro, port: {}}}, desk: {{device: {{driver: sacn, interface: near}}}}}}
  - {{number: 2, port: {{driver: sacn, interface: near}}}}
  - {{number: 3, port: {{driver: artnet, interface: aside}}}}
fixtures:
  - {{name: spot, universe: 1, address: 1, channels: [intensity]}}
  - {{name: wash, universe: 2, address: 1, channels: [intensity]}}
  - {{name: far, universe: 3, address: 1, channels: [intensity]}}
relay_banks: [{{name: street, device: {}}}]
relays: [{{name: road, coil: 0, safe: on}}]
contact_banks: [{{name: doors, device: {}}}]
contacts: [{{name: gate, input: 0, closes: go}}]
cue_controller: {{device: {{driver: usb_hid, vendor: 16c0, product: 27d9}}, buttons: {{go: 1, back: 2}}}}
camera:
  device: {{driver: v4l2, serial: {}, size: [64, 48], rate: .1}}
  size: [64, 48]
  field_of_view: 60
  position: [0, 2, 9]
  look_at: [0, 1, 0]
)",
                           widget_.file().string(), inside(relays_->options(0) + "response_timeout: 0.2\n"),
                           inside(contacts_->options(0) + "response_timeout: 0.2\n"), camera_.kind().serial);
    }

    // Reads the program's next line, which may hold several sentences, even of one device.
    // False: there is none.
    bool hear(RunningProgram& program) {
        const auto said = program.line();
        const std::string line = said.value_or("");
        for (const Plug& plug : plugs_)
            for (const std::string& device : plug.devices)
                for (std::size_t named = 0; (named = line.find(" " + device + " (", named)) != std::string::npos; ++named) {
                    const std::string_view news = std::string_view(line).substr(line.find(')', named));
                    if (news.starts_with(") is missing")) missing_.insert(device);
                    if (news.starts_with(") is back")) missing_.erase(device);
                }
        camera_.send({.bytes = std::vector<std::uint8_t>(64 * 48 * 2, 128)});  // to nobody if it is unplugged
        return said.has_value();
    }
    // Whether the program has reported a plug's state.
    bool isTold(const Plug& plug) const {
        return std::ranges::all_of(plug.devices, [&](const std::string& device) { return missing_.contains(device) != plug.in; });
    }
    std::string untold() const {
        std::string names;
        for (const Plug& plug : plugs_)
            if (!isTold(plug)) names += fmt::format("{} is {}; ", fmt::join(plug.devices, ", "), plug.in ? "in" : "out");
        return names;
    }
    static constexpr int kPatience = 60;  // lines of the program
    // Unplugs and replugs every plug `times` times, in random order: another one whenever the
    // program has noticed.
    void plugAndUnplug(RunningProgram& program, int times) {
        for (Plug& plug : plugs_) plug.pulls = 0;
        const auto isDone = [&](const Plug& plug) { return plug.in && plug.pulls == times && isTold(plug); };
        for (int idle = 0; !std::ranges::all_of(plugs_, isDone); ++idle) {
            for (Plug& plug : plugs_) {
                if (!isTold(plug) || isDone(plug) || rng_.below(4) == 0) continue;
                plug.pulls += plug.in;
                plug.in = !plug.in;
                plug.put(plug.in);
                idle = 0;
            }
            // There is news only if something was unplugged or plugged in.
            if (std::ranges::all_of(plugs_, [&](const Plug& plug) { return isTold(plug); })) continue;
            ASSERT_TRUE(idle < kPatience && hear(program)) << untold() << "\n" << program.all();
        }
    }
    // Presses GO or BACK.
    void press(int button) {
        for (const int state : {1 << (button - 1), 0}) usb_.report(hand_.path, 0, {static_cast<std::uint8_t>(state)});
    }

    const std::vector<std::uint8_t> kEdid = edidBlock({.serial = "LEFT"});
    std::unique_ptr<Projectors> projectors_;
    Rng rng_{7};
    const ScratchFolder folder_;
    MockMachine machine_;
    MockUsb usb_{machine_};
    MockUsbDevice hand_;
    MockCamera camera_{machine_, {.serial = "EYE-1", .usb = "1-7", .rates = {{"YUYV", .1}}}};
    int node_ = 0;
    contract::WidgetSocket widget_;
    std::optional<ModbusPeer> relays_, contacts_;
    std::vector<Plug> plugs_;
    std::set<std::string> missing_;  // as reported by the program
};

TEST_F(Plugging, at_the_real_drivers_leaves_nothing_over_and_the_show_goes_on) {
    // The allocator keeps more for every thread than a hundred losses cost, and not the same each
    // time.
    ::setenv("MALLOC_ARENA_MAX", "1", 1);
    RunningProgram program({"run", ".", "--site", ".", "--from", "One", "--report", "report.json"}, folder_.path());
    // Wait for the devices, because a projector that is off would switch on by itself.
    while (program.all().find("cue 1 of 2") == std::string::npos) ASSERT_TRUE(hear(program)) << program.all();
    plugAndUnplug(program, 3);  // whatever the libraries keep from their first uses
    struct Holdings {
        std::ptrdiff_t files, threads;
        long kibibytes;
    };
    const auto look = [&] { return Holdings{program.countOf("fd"), program.countOf("task"), program.kibibytes()}; };
    // The least and the most of several looks. A file may be open for a moment only; and a device
    // that answers late on a busy machine may have no file for a moment.
    const auto holdings = [&] {
        SteadyClock clock;
        Holdings least = look(), most = least;
        for (int looks = 1; looks < 20; ++looks) {
            clock.sleepUntil(clock.now() + std::chrono::milliseconds(20));
            const Holdings now = look();
            least = {std::min(least.files, now.files), std::min(least.threads, now.threads),
                     std::min(least.kibibytes, now.kibibytes)};
            most = {std::max(most.files, now.files), std::max(most.threads, now.threads),
                    std::max(most.kibibytes, now.kibibytes)};
        }
        return std::pair(least, most);
    };
    const auto [leastBefore, before] = holdings();
    const auto filesBefore = program.openFiles();
    plugAndUnplug(program, kTimes);
    if (HasFatalFailure()) return;
    const Holdings after = holdings().first;
    fmt::print("{} files, {} threads, {} KiB before; {}, {}, {} KiB after\n", before.files, before.threads, leastBefore.kibibytes,
               after.files, after.threads, after.kibibytes);
    EXPECT_LE(after.files, before.files) << fmt::format("before: {}\nafter: {}", filesBefore, program.openFiles());
    EXPECT_LE(after.threads, before.threads);
#ifndef FANTASCOPE_SANITIZED
    constexpr long kAtEveryLoss = 1;  // KiB, of the report's and the allocator's; the leak sanitizer finds real leaks
    EXPECT_LT(after.kibibytes, leastBefore.kibibytes + kAtEveryLoss * kTimes * std::ssize(plugs_));
#endif

    // Everything still works.
    press(1);
    const auto comesTrue = [&](const std::function<bool()>& condition) {
        SteadyClock clock;
        for (int looks = 0; looks < 1000 && !condition(); ++looks) clock.sleepUntil(clock.now() + std::chrono::milliseconds(20));
        return condition();
    };
    EXPECT_TRUE(comesTrue([&] { return relays_->ask("get 0 c 0 1") == "1"; })) << "the second cue's relay";
    EXPECT_TRUE(comesTrue([&] { return widget_.widget().out() && widget_.widget().out()->at(0) == 51; })) << "its lamp";
    EXPECT_EQ(widget_.widget().complaint(), "");
    EXPECT_EQ(program.stop(), 0) << program.all();
    const auto report = nlohmann::json::parse(contentsOf(folder_ / "report.json"));
    EXPECT_EQ(report["cues"].size(), 2u) << "no plug has pressed a button";
    // Alone it is drawn 30 times a second; beside a projector, at the projector's rate.
    EXPECT_GE(report["frames_by_output"]["right"].get<double>() + report["late_frames_by_output"]["right"].get<double>(),
              30 * report["seconds"].get<double>() - 1)
        << "it stood still";
}

}  // namespace
}  // namespace fantascope::peers

int main(int count, char** arguments) {
    if (!fantascope::underUmockdev(arguments)) {
        std::puts("skipped: all tests: Debian's package umockdev is not installed, see tools/peers");
        return fantascope::kSkipped;
    }
    fantascope::peers::enterOwnNetwork();  // before anything starts a thread
    return fantascope::runTests(count, arguments);
}
