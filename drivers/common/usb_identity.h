#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::drivers {

// What a USB device reports about itself and where it is plugged in, as listed by the kernel under
// /sys.
struct UsbIdentity {
    std::string vendor, product;             // four hexadecimal digits each: "0403", "6001"
    std::string manufacturer, name, serial;  // as the device reports them; may be empty
    std::string path;                        // bus and ports: "1-1.4"
    friend bool operator==(const UsbIdentity&, const UsbIdentity&) = default;
};

// The device at a path ("1-1.4"); nothing if there is none.
std::optional<UsbIdentity> usbIdentityAt(const std::string& path);

// A device file of a USB device, such as /dev/ttyUSB0 or /dev/video2.
struct UsbFile {
    std::filesystem::path file;
    UsbIdentity usb;
    int interface = 0;  // of the USB device; one may have several
};

// The device that the kernel lists as /sys/class/CLASS/NAME; nothing if it is not on USB.
std::optional<UsbFile> usbFileOf(const std::string& deviceClass, const std::string& name);

// All devices of a class ("tty", "video4linux"), sorted by USB path and interface.
std::vector<UsbFile> usbFilesOf(const std::string& deviceClass);

}  // namespace fantascope::drivers
