#pragma once

#include "drivers/common/found_device.h"
#include "drivers/common/usb_identity.h"

#include <vector>

namespace fantascope::drivers {

// The serial lines of this machine that hang on USB: units on them may be anything, so none is
// asked. What is on a network needs its host declared. Returns at once.
std::vector<FoundDevice> findModbusLines();
FoundDevice modbusLineOn(const UsbFile& file);

}  // namespace fantascope::drivers
