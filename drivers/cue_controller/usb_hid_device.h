#pragma once

#include "drivers/cue_controller/button_events.h"
#include "drivers/cue_controller/button_lights.h"
#include "drivers/cue_controller/hid_buttons.h"
#include "drivers/cue_controller/hid_lamps.h"
#include "drivers/cue_controller/hid_profile.h"
#include "drivers/cue_controller/usb_bus.h"

#include "core/clock.h"

#include <atomic>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

struct libusb_device_handle;
struct libusb_transfer;

namespace fantascope::drivers {

// One life of a USB HID device: opened, its interfaces held, its reports listened to and its lamps
// lit. At its end the kernel's drivers have it again. Thread: bound to the device's; it works while
// the bus waits.
class UsbHidDevice {
public:
    // What of it goes on when the device is gone.
    struct Around {
        UsbBus& bus;
        Clock& clock;
        ButtonEvents& events;
        ButtonLights& lights;
        const std::atomic<bool>& leaving;
    };
    // `profile` may be null. brightness: of the lamps, 0..1.
    UsbHidDevice(const Around& around, const ListedDevice& device, const HidProfile* profile, double brightness);
    ~UsbHidDevice();
    UsbHidDevice(const UsbHidDevice&) = delete;
    UsbHidDevice& operator=(const UsbHidDevice&) = delete;

    // Why it is over, or never began.
    const std::optional<Outage>& outage() const { return outage_; }
    // What it does not do although it lives.
    const std::string& trouble() const { return trouble_; }

    // Takes the state in which the device is for known, and asks it for that where `asks`.
    void settle(bool asks);
    // What is to be done between two waits of the bus: endpoints that have stopped, and lights that
    // have changed.
    void tend();
    // Farewell to a device that is still there: all its lamps go off, unless it takes too long.
    void darken();

private:
    using Handle = std::unique_ptr<libusb_device_handle, void (*)(libusb_device_handle*)>;
    using Transfer = std::unique_ptr<libusb_transfer, void (*)(libusb_transfer*)>;

    bool claim(const std::vector<HidEndpoints>& interfaces);
    bool layOut(const HidProfile* profile);
    void listen();
    void askState();
    void take(int interface, std::span<const std::uint8_t> report);
    void submit(libusb_transfer* transfer);
    static void completed(libusb_transfer* transfer);

    void startLamps();
    void sendLights();
    void submitReport(const HidOutReport& report);
    bool sendNow(const HidOutReport& report);
    std::uint8_t outEndpointOf(const HidOutReport& report) const;
    static void sent(libusb_transfer* transfer);
    void failToSend();

    const Around around_;
    const std::filesystem::path file_;
    Handle handle_;
    std::optional<Outage> outage_;
    std::string trouble_;
    std::vector<HidEndpoints> claimed_;
    std::vector<HidInterface> interfaces_;
    std::optional<HidButtons> buttons_;
    std::map<std::uint8_t, int> interfaceOf_;  // by endpoint
    std::vector<std::vector<std::uint8_t>> buffers_;
    std::vector<Transfer> transfers_;
    std::vector<libusb_transfer*> stopped_;
    int inFlight_ = 0, errors_ = 0;
    bool isSettled_ = false, isEnding_ = false;

    const double brightness_;
    std::unique_ptr<HidLamps> lamps_;    // null: it has none, or takes nothing
    std::deque<HidOutReport> outgoing_;  // the first one is on its way while isSending_
    std::vector<std::uint8_t> sending_;
    Transfer outTransfer_;
    bool isSending_ = false, isOutStopped_ = false;
    int failures_ = 0;    // to send, one after the other
    Time nextAttempt_{};  // to send
};

}  // namespace fantascope::drivers
