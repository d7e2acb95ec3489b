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

// One life of a USB HID device: opens it, claims its interfaces, listens to its reports and lights
// its lamps. The destructor gives it back to the kernel's drivers. Thread: bound to the device's
// thread; it works during UsbBus::wait().
class UsbHidDevice {
public:
    // What outlives the device.
    struct Environment {
        UsbBus& bus;
        Clock& clock;
        ButtonEvents& events;
        ButtonLights& lights;
        const std::atomic<bool>& closing;
    };
    // `profile` may be null. `brightness`: of the lamps, 0..1.
    UsbHidDevice(const Environment& environment, const ListedDevice& device, const HidProfile* profile, double brightness);
    ~UsbHidDevice();
    UsbHidDevice(const UsbHidDevice&) = delete;
    UsbHidDevice& operator=(const UsbHidDevice&) = delete;

    // Why its life has ended, or could not begin.
    const std::optional<Outage>& outage() const { return outage_; }
    // What fails although it is alive.
    const std::string& trouble() const { return trouble_; }

    // Waits a moment for reports from before this life and takes the buttons' state as known.
    // `ask`: also requests the state.
    void readInitialState(bool ask);
    // Call between two waits of the bus: restarts halted endpoints, and sends lights that have
    // changed.
    void poll();
    // Before the end of a device that is still there: switches all its lamps off, unless that takes
    // too long.
    void darken();

private:
    using Handle = std::unique_ptr<libusb_device_handle, void (*)(libusb_device_handle*)>;
    using Transfer = std::unique_ptr<libusb_transfer, void (*)(libusb_transfer*)>;

    bool claim(const std::vector<HidEndpoints>& interfaces);
    bool readLayout(const HidProfile* profile);
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

    const Environment environment_;
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
    std::unique_ptr<HidLamps> lamps_;    // null: it has none, or refuses lights
    std::deque<HidOutReport> outgoing_;  // the first one is being sent while isSending_
    std::vector<std::uint8_t> sending_;
    Transfer outTransfer_;
    bool isSending_ = false, isOutStopped_ = false;
    int failures_ = 0;    // consecutive, to send
    Time nextAttempt_{};  // to send
};

}  // namespace fantascope::drivers
