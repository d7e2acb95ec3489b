// A day's worth of plugging: every device of a site goes and comes back a hundred times, in random
// order, while a show runs.

#include "app/live/show_run.h"

#include "core/check.h"
#include "core/random.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <malloc.h>

#include <algorithm>
#include <filesystem>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;

constexpr std::string_view kShow = R"(fantascope: show
version: 1
title: Test
sources:
  red: {solid: [1, 0, 0]}
  seen: {camera: {}}
looks:
  one: {outputs: {left: [{source: red}], right: [{source: seen}]}, fixtures: {spot: 1}, relays: {street: off}}
  two: {outputs: {left: [{source: seen}], right: [{source: red}]}}
cues: [{name: One, look: one, fade: 1}, {name: Two, look: two, fade: 1}]
)";

// Small, with a device of every kind.
constexpr std::string_view kSite = R"(fantascope: site
version: 1
outputs:
  - {name: left, display: {driver: headless}, size: [64, 36], refresh_rate: 30,
     projector: {position: [1, 2, 8], look_at: [-1, 1, 0], throw_ratio: 1.5}}
  - {name: right, display: {driver: headless}, size: [64, 36], refresh_rate: 30,
     projector: {position: [-1, 2, 8], look_at: [1, 1, 0], throw_ratio: 1.5}}
universes: [{number: 1, port: {driver: simulated}}, {number: 2, port: {driver: simulated}}]
fixtures: [{name: spot, universe: 1, address: 1, channels: [intensity]}]
relay_banks: [{name: road, device: {driver: simulated}}, {name: park, device: {driver: simulated}}]
relays: [{name: street, bank: road, coil: 0, safe: on}, {name: path, bank: park, coil: 0, safe: on}]
cue_controller: {device: {driver: simulated}, buttons: {go: 1}}
contact_banks: [{name: doors, device: {driver: simulated}}]
contacts: [{name: gate, input: 0, closes: go}]
camera: {device: {driver: simulated}, size: [48, 27], field_of_view: 60, position: [0, 2, 9], look_at: [0, 1, 0]}
simulation:
  objects: [{name: wall, rectangle: {corner: [-9, 0, 0], right: [18, 0, 0], up: [0, 5, 0]}}]
  projectors: {left: {lumens: 3000}, right: {lumens: 3000}}
  camera: {white: 30}
  faults:
)";

constexpr std::array kDevices = {"left", "right", "universe 1",     "universe 2", "road",
                                 "park", "doors", "cue controller", "camera"};

// The site with `times` faults of each device, one every `kApart`, in an order of chance.
constexpr double kApart = 0.05, kGone = 0.03;  // seconds
std::string siteWith(std::size_t times, std::uint64_t seed) {
    std::vector<std::string> devices;
    for (const char* device : kDevices) devices.insert(devices.end(), times, device);
    Rng rng(seed);
    for (std::size_t left = devices.size(); left > 1; --left)
        std::swap(devices[left - 1], devices[rng.below(static_cast<std::uint32_t>(left))]);
    std::string site(kSite);
    for (std::size_t i = 0; i < devices.size(); ++i) {
        const double at = 1 + static_cast<double>(i) * kApart;
        site += fmt::format("    - {{kind: unplug, device: {}, at: {:.3f}, until: {:.3f}}}\n", devices[i], at, at + kGone);
    }
    return site;
}

// A rehearsal shows what a gate does: whoever passes it enters the next cue.
TEST(RehearsalOfContacts, a_gate_of_the_simulated_site_steps_the_cues) {
    const ScratchFolder folder;
    folder.file("show.yaml", kShow);
    const std::string untilFaults(kSite.substr(0, kSite.rfind("  faults:")));
    folder.file("site.yaml", untilFaults + "  contacts: [{contact: gate, at: 0.5, until: 1}, {contact: gate, at: 2}]\n");
    RunOptions options;
    options.show = folder.path();
    options.site = folder.path();
    options.backends = Backends::SimulatedHeadless;
    options.asFastAsPossible = true;
    options.length = 3s;
    const Interrupt interrupt;
    const auto report = runShow(options, interrupt, [](const RunStatus&) {});
    ASSERT_TRUE(report) << report.error().message();
    ASSERT_EQ(report->cues.size(), 2u);
    constexpr Time kTicks = 14ms;  // one of the simulated site and one of the input part
    for (const auto& [cue, at] : {std::pair(0u, Time(500ms)), std::pair(1u, Time(2s))}) {
        EXPECT_GE(report->cues[cue].entered, at);
        EXPECT_LE(report->cues[cue].entered, at + kTicks);
    }
}

// What a process holds.
struct Holdings {
    std::ptrdiff_t files = 0, threads = 0;
    std::size_t bytes = 0;
};

std::ptrdiff_t countIn(const char* folder) {
    return std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator());
}

Holdings holdings() { return {countIn("/proc/self/fd"), countIn("/proc/self/task"), mallinfo2().uordblks}; }

struct Day {
    std::size_t faults = 0, cues = 0;
    std::array<double, 2> shown{};  // of each output's refreshes, the share that had a frame
    Holdings noon, evening, after;
};

Day dayOf(const ScratchFolder& folder, std::size_t times) {
    folder.file("site.yaml", siteWith(times, times));
    RunOptions options;
    options.show = folder.path();
    options.site = folder.path();
    options.backends = Backends::SimulatedHeadless;
    options.asFastAsPossible = true;
    options.handsOff = true;
    options.length = fromSeconds(2 + kApart * static_cast<double>(times * kDevices.size()));
    Day day;
    {
        const Interrupt interrupt;
        const auto report = runShow(options, interrupt, [&](const RunStatus& status) {
            (status.showTime < *options.length / 2 ? day.noon : day.evening) = holdings();
        });
        FANTASCOPE_CHECK(report.has_value(), report.error().message());
        // What the site did; what the show noticed of it names the device.
        day.faults = static_cast<std::size_t>(
            std::ranges::count_if(report->faults, [](const FaultReport& fault) { return fault.device.empty(); }));
        day.cues = report->cues.size();
        for (std::size_t output = 0; output < 2; ++output)
            day.shown[output] = static_cast<double>(report->outputs[output].frames) / (30 * seconds(report->length));
    }
    day.after = holdings();
    return day;
}

TEST(Plugging, a_hundred_times_each_leaves_nothing_over_and_the_show_goes_on) {
    constexpr std::size_t kTimes = 100;
    const ScratchFolder folder;
    folder.file("show.yaml", kShow);
    for (int libraries = 0; libraries < 2; ++libraries) dayOf(folder, kTimes);  // whatever they keep from their first uses
    const Day before = dayOf(folder, kTimes);
    const Day day = dayOf(folder, kTimes);

    EXPECT_EQ(day.faults, 2 * kTimes * kDevices.size()) << "each going and each coming";
    EXPECT_EQ(day.cues, 2u) << "the hand got through between its own losses";
    // An absence, shorter than a refresh, costs the one that it falls on and the one until which
    // the display is back.
    constexpr double kRefreshes = 30 * (2 + kApart * static_cast<double>(kTimes * kDevices.size()));
    for (const double share : day.shown) EXPECT_GE(share, 1 - 2 * static_cast<double>(kTimes) / kRefreshes);
    EXPECT_EQ(day.evening.files, day.noon.files);
    EXPECT_EQ(day.evening.threads, day.noon.threads);
    EXPECT_EQ(day.after.files, before.after.files);
    EXPECT_EQ(day.after.threads, before.after.threads);
    constexpr std::size_t kSmallestThing = 100;  // bytes that would stay behind at every loss
    EXPECT_LT(day.after.bytes, before.after.bytes + kSmallestThing * kTimes);
}

}  // namespace
}  // namespace fantascope::app
