#pragma once
// USB through libusb, and the HID devices on it.

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

// A libusb context, made by the first start(). Thread: interrupt() from any, the rest from the
// device's thread.
class UsbBus {
public:
    UsbBus() = default;
    ~UsbBus();
    UsbBus(const UsbBus&) = delete;
    UsbBus& operator=(const UsbBus&) = delete;

    // Error: no usable USB on this machine.
    Result<void> start();
    libusb_context* context() const { return context_; }

    // Waits until something happens on the USB, interrupt() is called, or `timeout` has passed.
    void wait(Time timeout);
    void interrupt();

private:
    std::atomic<libusb_context*> context_ = nullptr;
};

// A listed device, valid as long as it is held.
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

// The devices with a HID interface, sorted by path.
std::vector<ListedDevice> hidDevices(libusb_context* context);

// A HID interface with an endpoint for input reports.
struct HidEndpoints {
    int number = 0;
    std::uint8_t in = 0, out = 0;      // interrupt endpoints; out 0: output reports use the control pipe
    std::size_t packet = 0;            // maximum bytes of `in`
    std::uint16_t descriptorSize = 0;  // of its report descriptor
};
std::vector<HidEndpoints> hidInterfacesOf(libusb_device* device);

// Its file in usbfs.
std::filesystem::path fileOf(libusb_device* device);

// The outage for a libusb error while opening, claiming or reaching a device.
Outage outageOf(int error, const std::filesystem::path& file);

}  // namespace fantascope::drivers
