#pragma once
// The USB as libusb shows it, and the HID devices on it.

#include "drivers/common/file_handle.h"
#include "drivers/common/usb_identity.h"

#include "core/clock.h"
#include "core/result.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

struct libusb_context;
struct libusb_device;

namespace fantascope::drivers {

// libusb, from the first time that it starts. Thread: interrupt() from any, the rest from the
// device's.
class UsbBus {
public:
    UsbBus() = default;
    ~UsbBus();
    UsbBus(const UsbBus&) = delete;
    UsbBus& operator=(const UsbBus&) = delete;

    // Error: this machine has no USB that could be used.
    Result<void> start();
    libusb_context* context() const { return context_; }

    // Until something has happened on the USB, it was interrupted, or `patience` is over.
    void wait(Time patience);
    void interrupt();

private:
    std::atomic<libusb_context*> context_ = nullptr;
};

// A device on the list, for as long as it is held.
class ListedDevice {
public:
    ListedDevice(libusb_device* device, UsbIdentity usb);
    ~ListedDevice();
    ListedDevice(ListedDevice&& other) noexcept;
    ListedDevice& operator=(ListedDevice&& other) noexcept;
    libusb_device* get() const { return device_; }

    UsbIdentity usb;

private:
    libusb_device* device_;
};

// The devices with a HID interface, by their path.
std::vector<ListedDevice> hidDevices(libusb_context* context);

// A HID interface with reports to be heard.
struct HidEndpoints {
    int number = 0;
    std::uint8_t in = 0, out = 0;      // interrupt endpoints; out 0: reports to it go over the control pipe
    std::size_t packet = 0;            // bytes at most, of `in`
    std::uint16_t descriptorSize = 0;  // of its report descriptor
};
std::vector<HidEndpoints> hidInterfacesOf(libusb_device* device);

// Its file of usbfs.
std::filesystem::path fileOf(libusb_device* device);

// What libusb says when it does not open, claim or reach a device.
Outage outageOf(int error, const std::filesystem::path& file);

}  // namespace fantascope::drivers
