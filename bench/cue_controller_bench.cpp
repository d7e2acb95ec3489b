// Measures the latency of a press from USB to poll(): through usbfs (replaced by umockdev, which
// uses a socket and is slower than the kernel), libusb, the descriptor, the debounce and the queue.
// Then the whole program runs a show, and the same is measured until the first refresh whose
// picture is another one. Prints percentiles in milliseconds. They do not include the host
// controller's polling interval (bInterval, 1 to 10 ms on common devices).

#include "drivers/cue_controller/usb_hid.h"

#include "contract/mock_usb.h"
#include "core/check.h"
#include "core/file.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace fantascope {
namespace {

double percentile(const std::vector<double>& sorted, double share) {
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

void print(const char* what, std::vector<double> milliseconds) {
    std::sort(milliseconds.begin(), milliseconds.end());
    fmt::print("{:24} p50 {:.3f}  p99 {:.3f}  p99.9 {:.3f}  max {:.3f} ms, {} presses\n", what, percentile(milliseconds, 0.5),
               percentile(milliseconds, 0.99), percentile(milliseconds, 0.999), milliseconds.back(), milliseconds.size());
}

MockUsbDevice gamepad() {
    MockUsbDevice device;
    device.reportDescriptors = {{0x05, 0x01, 0x09, 0x05, 0xa1, 0x01, 0x05, 0x09, 0x19, 0x01, 0x29, 0x08,
                                 0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x08, 0x81, 0x02, 0xc0}};
    return device;
}

void pressToEvent(int presses) {
    SteadyClock clock;
    MockMachine machine;
    MockUsb usb(machine);
    usb.plug(gamepad());
    const auto options = ConfigNode::parse("{driver: usb_hid, serial: CUE-7}\n", "site.yaml").value();
    const auto controller = drivers::UsbHidController::fromConfig(options).value().open({clock}).value();
    while (controller->status().state != DeviceState::Running) std::this_thread::yield();
    std::vector<double> arrived, polled;
    for (int press = 0; press < presses; ++press)
        for (const bool down : {true, false}) {
            clock.sleepUntil(clock.now() + std::chrono::milliseconds(6));  // longer than the debounce
            const Time start = clock.now();
            usb.report("1-1", 0, {static_cast<std::uint8_t>(down)});
            std::optional<ButtonEvent> event;
            while (!(event = controller->poll())) std::this_thread::yield();
            FANTASCOPE_CHECK(event->pressed == down, "presses and releases alternate");
            if (!down) continue;
            arrived.push_back(1e3 * seconds(event->at - start));
            polled.push_back(1e3 * seconds(clock.now() - start));
        }
    print("press to time stamp", std::move(arrived));
    print("press to poll", std::move(polled));
}

constexpr double kRate = 30;  // Hz, of the outputs

constexpr const char* kShow = R"(fantascope: show
version: 2
title: Red and blue
go_interval: 0
at_end: loop
sources: {red: {solid: [1, 0, 0]}, blue: {solid: [0, 0, 1]}}
looks: {red: {outputs: {left: [{source: red}], right: [{source: red}]}}, blue: {outputs: {left: [{source: blue}], right: [{source: blue}]}}}
cues: [{name: Red, look: red, fade: 0}, {name: Blue, look: blue, fade: 0}]
)";
constexpr const char* kSite = R"(fantascope: site
version: 1
outputs:
  - {name: left, display: {driver: headless}, size: [320, 180], refresh_rate: 30}
  - {name: right, display: {driver: headless}, size: [320, 180], refresh_rate: 30}
cue_controller: {device: {driver: usb_hid, serial: CUE-7}, buttons: {go: 1}}
)";

// The moments in show time, seconds, at which the left output shows another picture than before.
std::vector<double> changesIn(const std::filesystem::path& table) {
    std::istringstream lines(readFile(table).value());
    std::vector<double> changes;
    std::string line, before;
    for (std::getline(lines, line); std::getline(lines, line);) {
        std::array<std::string, 4> fields;
        std::istringstream text(line);
        for (std::string& field : fields) std::getline(text, field, ',');
        if (fields[2] != "left") continue;
        if (!before.empty() && fields[3] != before) changes.push_back(std::stod(fields[1]));
        before = fields[3];
    }
    return changes;
}

// The moments in show time, seconds, of the presses that the program took.
std::vector<double> pressesIn(const std::filesystem::path& journal) {
    std::istringstream lines(readFile(journal).value());
    std::vector<double> presses;
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string check, kind, what;
        double time = 0;
        words >> check >> kind >> time >> what;
        if (kind == "input" && what == "go") presses.push_back(time / 1e9);
    }
    return presses;
}

// The show's clock and ours differ by a constant. It is found by the press that arrived soonest, as
// if that had taken no time at all.
void pressToRefresh(int presses) {
    SteadyClock clock;
    MockMachine machine;
    MockUsb usb(machine);
    usb.plug(gamepad());
    const ScratchFolder folder;
    folder.file("show.yaml", kShow);
    folder.file("site.yaml", kSite);
    const std::string program = fmt::format("cd '{}' && exec '{}' run . --site . --journal . --record seen >said 2>&1 </dev/null",
                                            folder.path().string(), FANTASCOPE_PROGRAM);
    const pid_t child = fork();
    if (child == 0) {
        execl("/bin/sh", "sh", "-c", program.c_str(), nullptr);
        _exit(127);
    }
    while (!usb.isHeard("1-1")) std::this_thread::yield();
    clock.sleepUntil(clock.now() + std::chrono::seconds(3));
    std::vector<double> pressed;
    for (int press = 0; press < presses; ++press)
        for (const bool down : {true, false}) {
            // So the presses fall on all phases of a period.
            clock.sleepUntil(clock.now() + std::chrono::milliseconds(down ? 357 : 50));
            if (down) pressed.push_back(seconds(clock.now()));
            usb.report("1-1", 0, {static_cast<std::uint8_t>(down)});
        }
    clock.sleepUntil(clock.now() + std::chrono::seconds(1));
    kill(child, SIGINT);
    waitpid(child, nullptr, 0);
    const std::vector<double> taken = pressesIn(folder / "journal"), changed = changesIn(folder / "seen/frames.csv");
    if (taken.size() != pressed.size() || changed.size() < pressed.size()) {
        fmt::print("{} presses, {} were taken, {} changes of the picture:\n{}\n", pressed.size(), taken.size(), changed.size(),
                   readFile(folder / "said").value());
        return;
    }
    double offset = taken[0] - pressed[0];
    for (std::size_t i = 0; i < pressed.size(); ++i) offset = std::min(offset, taken[i] - pressed[i]);
    std::vector<double> seen;
    for (const double press : pressed) {
        const auto next = std::ranges::upper_bound(changed, press + offset);
        FANTASCOPE_CHECK(next != changed.end(), "every press is seen");
        seen.push_back(1e3 * (*next - press - offset));
    }
    print("press to refresh", std::move(seen));
    fmt::print("wanted, p99: {:.1f} ms\n", 1.5e3 / kRate + 5);
}

}  // namespace
}  // namespace fantascope

int main(int, char** arguments) {
    FANTASCOPE_CHECK(fantascope::underUmockdev(arguments), "Debian's package umockdev is installed");
    fantascope::pressToEvent(2000);
    fantascope::pressToRefresh(150);
}
