#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::drivers {

// What a USB device says of itself and where it is plugged in, as the kernel lists it under /sys.
struct UsbIdentity {
    std::string vendor, product;             // four hexadecimal digits each: "0403", "6001"
    std::string manufacturer, name, serial;  // as the device says; empty where it says nothing
    std::string path;                        // bus and ports: "1-1.4"
    friend bool operator==(const UsbIdentity&, const UsbIdentity&) = default;
};

// Of the device that is plugged in at a path ("1-1.4"); nothing where there is none.
std::optional<UsbIdentity> usbIdentityAt(const std::string& path);

// A device file that a USB device has given, such as /dev/ttyUSB0 or /dev/video2.
struct UsbFile {
    std::filesystem::path file;
    UsbIdentity usb;
    int interface = 0;  // of the USB device: some have several of one kind
};

// Of a device that the kernel lists as /sys/class/CLASS/NAME; nothing where it hangs on no USB.
std::optional<UsbFile> usbFileOf(const std::string& deviceClass, const std::string& name);

// All of a class ("tty", "video4linux"), sorted by their USB path and interface.
std::vector<UsbFile> usbFilesOf(const std::string& deviceClass);

}  // namespace fantascope::drivers
