#include "app/devices.h"

#include "drivers/registry.h"

#include "show/patch.h"

namespace fantascope::app {
namespace {

// The declared options, or those of another driver without keys of its own, in the declared one's place.
Result<ConfigNode> optionsOf(const show::DeviceConfig& declared, Backends backends, const std::string& simulated) {
    if (backends == Backends::AsDeclared || declared.driver == simulated) return declared.options;
    return ConfigNode::parse("driver: " + simulated + "\n", declared.options.file());
}

}  // namespace

Result<Devices> openDevices(const show::Site& site, Backends backends, const drivers::Surroundings& around) {
    Devices devices;
    for (const show::Output& output : site.outputs) {
        const ConfigNode options =
            TRY(optionsOf(output.display, backends, backends == Backends::SimulatedWindows ? "glfw" : "headless"));
        devices.displays.push_back(TRY(drivers::openDisplay(options, {output.name, output.size, output.refreshRate}, around)));
    }
    for (const show::Universe& universe : site.universes) {
        const ConfigNode options = TRY(optionsOf(universe.port, backends, "simulated"));
        devices.lines.push_back({universe.number, TRY(drivers::openDmxPort(options, universe.number, around))});
    }
    if (site.relayBank) {
        const ConfigNode options = TRY(optionsOf(*site.relayBank, backends, "simulated"));
        devices.relayBank = TRY(drivers::openRelayBank(options, show::safeCoils(site), around));
    }
    if (site.cueController) {
        const ConfigNode options = TRY(optionsOf(*site.cueController, backends, "simulated"));
        devices.cueController = TRY(drivers::openCueController(options, around));
    }
    if (site.camera) {
        const ConfigNode options = TRY(optionsOf(*site.camera, backends, "simulated"));
        devices.camera = TRY(drivers::openCamera(options, around));
    }
    return devices;
}

std::vector<DeviceStatus> Devices::statuses() const {
    std::vector<DeviceStatus> statuses;
    const auto add = [&](const auto& device) {
        if (device) statuses.push_back(device->status());
    };
    for (const auto& display : displays) add(display);
    for (const Line& line : lines) add(line.port);
    add(relayBank);
    add(cueController);
    add(camera);
    return statuses;
}

}  // namespace fantascope::app
