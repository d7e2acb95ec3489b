#include "drivers/display/find_monitors.h"

#include "drivers/display/x_screen.h"

#include <fmt/format.h>

namespace fantascope::drivers {

std::vector<FoundDevice> findMonitors() {
    std::vector<FoundDevice> found;
    const auto screen = XScreen::open();
    if (!screen) return found;
    const auto monitors = (*screen)->monitors();
    if (!monitors) return found;
    for (const Monitor& monitor : *monitors) {
        if (!monitor.connected) continue;
        const MonitorIdentity identity = monitor.identity.value_or(MonitorIdentity());
        FoundDevice device{"display", "a monitor that does not say what it is", "", monitor.connector, "", ""};
        if (monitor.identity) device.what = fmt::format("{} {}", identity.make, identity.model);
        if (!identity.serial.empty()) device.identity = "serial " + identity.serial;
        if (monitor.on)
            device.what +=
                fmt::format(", {} x {} at {:.2f} Hz", monitor.on->area.size.x, monitor.on->area.size.y, monitor.on->mode.hertz);
        // The shortest description that identifies it: without a serial number, its connector.
        const MonitorChoice choice = identity.serial.empty() ? MonitorChoice{monitor.connector, "", "", ""}
                                                             : MonitorChoice{"", identity.make, "", identity.serial};
        device.options = fmt::format("{{driver: glfw, monitor: {}}}", choice.text());
        found.push_back(std::move(device));
    }
    return found;
}

Result<std::vector<Placement::Seat>> lookForMonitors(const std::vector<MonitorClaim>& claims) {
    const auto screen = TRY(XScreen::open());
    const auto monitors = TRY(screen->monitors());
    Placement placement;
    std::vector<int> numbers;
    for (const MonitorClaim& claim : claims) numbers.push_back(placement.add(claim));
    const Placement::Plan plan = placement.look(monitors, screen->largest());
    std::map<int, Placement::Seat> seats = placement.seats();
    for (const Placement::Change& change : plan.changes) seats[change.claim].absence.clear();
    std::vector<Placement::Seat> found;
    for (const int number : numbers) found.push_back(seats[number]);
    return found;
}

}  // namespace fantascope::drivers
