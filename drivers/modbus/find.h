#pragma once

#include "drivers/common/found_device.h"
#include "drivers/common/usb_identity.h"

#include <vector>

namespace fantascope::drivers {

// The USB serial lines of this machine. Units on them may be anything, so none is asked. Units on a
// network are not searched: they need their host declared. Returns at once.
std::vector<FoundDevice> findModbusLines();
FoundDevice modbusLineOn(const UsbFile& file);

}  // namespace fantascope::drivers
