// Measures the latency of a press from USB to poll(): through usbfs (replaced by umockdev, which
// uses a socket and is slower than the kernel), libusb, the descriptor, the debounce and the queue.
// Prints percentiles in milliseconds. They do not include the host controller's polling interval
// (bInterval, 1 to 10 ms on common devices).

#include "drivers/cue_controller/usb_hid.h"

#include "contract/mock_usb.h"
#include "core/check.h"

#include <fmt/format.h>

#include <algorithm>
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

void pressToEvent(int presses) {
    SteadyClock clock;
    MockMachine machine;
    MockUsb usb(machine);
    MockUsbDevice device;
    device.reportDescriptors = {{0x05, 0x01, 0x09, 0x05, 0xa1, 0x01, 0x05, 0x09, 0x19, 0x01, 0x29, 0x08,
                                 0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x08, 0x81, 0x02, 0xc0}};
    usb.plug(device);
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

}  // namespace
}  // namespace fantascope

int main(int, char** arguments) {
    FANTASCOPE_CHECK(fantascope::underUmockdev(arguments), "Debian's package umockdev is installed");
    fantascope::pressToEvent(2000);
}
