#pragma once

#include "drivers/common/found_device.h"
#include "drivers/display/placement.h"

#include "core/result.h"

#include <vector>

namespace fantascope::drivers {

// The monitors and projectors on this machine's X screen; none where there is no X server. Thread:
// any; it waits for the X server.
std::vector<FoundDevice> findMonitors();

// Where these claims would find their monitors now, one each; nothing is switched, so a monitor
// that only has to be switched on is one that is there. Error: there is no X server.
Result<std::vector<Placement::Seat>> lookForMonitors(const std::vector<MonitorClaim>& claims);

}  // namespace fantascope::drivers
