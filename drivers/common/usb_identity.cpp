#include "drivers/common/usb_identity.h"

#include "core/text.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <system_error>
#include <tuple>

namespace fantascope::drivers {
namespace {

namespace fs = std::filesystem;

// The first line of an attribute; "" if there is none.
std::string attribute(const fs::path& folder, const char* name) {
    std::ifstream file(folder / name);
    std::string line;
    std::getline(file, line);
    while (!line.empty() && (line.back() == ' ' || line.back() == '\r')) line.pop_back();
    return printable(line);  // it appears in messages
}

std::optional<UsbIdentity> identityIn(const fs::path& folder) {
    UsbIdentity usb;
    usb.vendor = attribute(folder, "idVendor");
    if (usb.vendor.empty()) return std::nullopt;
    usb.product = attribute(folder, "idProduct");
    usb.manufacturer = attribute(folder, "manufacturer");
    usb.name = attribute(folder, "product");
    usb.serial = attribute(folder, "serial");
    usb.path = folder.filename().string();
    return usb;
}

}  // namespace

std::optional<UsbIdentity> usbIdentityAt(const std::string& path) { return identityIn(fs::path("/sys/bus/usb/devices") / path); }

std::optional<UsbFile> usbFileOf(const std::string& deviceClass, const std::string& name) {
    std::error_code gone;  // a device may vanish meanwhile
    fs::path folder = fs::canonical(fs::path("/sys/class") / deviceClass / name, gone);
    if (gone) return std::nullopt;
    UsbFile found{fs::path("/dev") / name, {}};
    for (; folder.has_relative_path() && folder != folder.parent_path(); folder = folder.parent_path()) {
        const std::string interface = attribute(folder, "bInterfaceNumber");
        if (!interface.empty()) found.interface = static_cast<int>(std::strtol(interface.c_str(), nullptr, 16));
        if (auto usb = identityIn(folder)) {
            found.usb = std::move(*usb);
            return found;
        }
    }
    return std::nullopt;
}

std::vector<UsbFile> usbFilesOf(const std::string& deviceClass) {
    std::vector<UsbFile> files;
    std::error_code none;
    for (const fs::directory_entry& entry : fs::directory_iterator(fs::path("/sys/class") / deviceClass, none))
        if (auto file = usbFileOf(deviceClass, entry.path().filename().string())) files.push_back(std::move(*file));
    std::sort(files.begin(), files.end(), [](const UsbFile& a, const UsbFile& b) {
        return std::tie(a.usb.path, a.interface, a.file) < std::tie(b.usb.path, b.interface, b.file);
    });
    return files;
}

}  // namespace fantascope::drivers
