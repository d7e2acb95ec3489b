#include "drivers/modbus/find.h"

#include "drivers/common/file_handle.h"

#include "core/config/config.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>

namespace fantascope::drivers {

FoundDevice modbusLineOn(const UsbFile& file) {
    const UsbIdentity& usb = file.usb;
    // Opening the line would change its control lines, so only the permission is checked.
    const int error = access(file.file.c_str(), R_OK | W_OK) == 0 ? 0 : errno;
    return {"modbus",
            fmt::format("{} {}", usb.manufacturer, usb.name),
            fmt::format("USB {}:{}{}{}", usb.vendor, usb.product, usb.serial.empty() ? "" : " serial ", usb.serial),
            file.file.string(),
            error == 0 ? "" : whyNotOpened(file.file, error).why,
            fmt::format("{{driver: modbus_rtu, usb: {{vendor: \"{}\", product: \"{}\"{}}}}}", usb.vendor, usb.product,
                        usb.serial.empty() ? "" : ", serial: " + fantascope::quoted(usb.serial))};
}

std::vector<FoundDevice> findModbusLines() {
    std::vector<FoundDevice> found;
    for (const UsbFile& file : usbFilesOf("tty")) found.push_back(modbusLineOn(file));
    return found;
}

}  // namespace fantascope::drivers
