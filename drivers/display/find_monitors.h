#pragma once

#include "drivers/common/found_device.h"
#include "drivers/display/placement.h"

#include "core/result.h"

#include <vector>

namespace fantascope::drivers {

// The monitors and projectors on this machine's X screen; none without an X server. Thread: any; it
// waits for the X server.
std::vector<FoundDevice> findMonitors();

// Where each of these claims would find its monitor now. Nothing is switched; a monitor that is
// only switched off counts as present. Error: there is no X server.
Result<std::vector<Placement::Seat>> lookForMonitors(const std::vector<MonitorClaim>& claims);

}  // namespace fantascope::drivers
