#include "app/devices.h"

#include "drivers/registry.h"

#include "show/patch.h"

namespace fantascope::app {
namespace {

// A driver without keys of its own in the place of the declared one.
Result<ConfigNode> plain(const std::string& driver, const show::DeviceConfig& declared) {
    return ConfigNode::parse("driver: " + driver + "\n", declared.options.file());
}

// The declared options, or those of the simulated driver.
Result<ConfigNode> optionsOf(const show::DeviceConfig& declared, Backends backends) {
    constexpr const char* kSimulated = "simulated";
    if (backends == Backends::AsDeclared || declared.driver == kSimulated) return declared.options;
    return plain(kSimulated, declared);
}

// Of a display: at home there are none of the site's monitors, so that even of its own driver it keeps no keys.
Result<ConfigNode> displayOptions(const show::DeviceConfig& declared, Backends backends) {
    if (backends == Backends::AsDeclared) return declared.options;
    return plain(backends == Backends::SimulatedWindows ? "glfw" : "headless", declared);
}

}  // namespace

Result<Devices> openDevices(const show::Site& site, Backends backends, const drivers::Surroundings& around) {
    Devices devices;
    for (const show::Output& output : site.outputs) {
        const ConfigNode options = TRY(displayOptions(output.display, backends));
        devices.displays.push_back(TRY(drivers::openDisplay(options, {output.name, output.size(), output.refreshRate}, around)));
    }
    for (const show::Universe& universe : site.universes) {
        const ConfigNode options = TRY(optionsOf(universe.port, backends));
        Devices::Line line{universe.number, TRY(drivers::openDmxPort(options, universe.number, around)), nullptr};
        if (universe.desk) {
            const ConfigNode desk = TRY(optionsOf(universe.desk->device, backends));
            line.desk = TRY(drivers::openDmxSource(desk, universe.number, around));
        }
        devices.lines.push_back(std::move(line));
    }
    for (std::size_t bank = 0; bank < site.relayBanks.size(); ++bank) {
        const ConfigNode options = TRY(optionsOf(site.relayBanks[bank].device, backends));
        devices.relayBanks.push_back(
            TRY(drivers::openRelayBank(options, site.relayBanks[bank].name, show::safeCoils(site, bank), around)));
    }
    if (site.cueController) {
        const ConfigNode options = TRY(optionsOf(*site.cueController, backends));
        devices.cueController = TRY(drivers::openCueController(options, around));
    }
    for (std::size_t bank = 0; bank < site.contactBanks.size(); ++bank) {
        const ConfigNode options = TRY(optionsOf(site.contactBanks[bank].device, backends));
        devices.contactBanks.push_back(
            TRY(drivers::openInputBank(options, site.contactBanks[bank].name, site.inputCount(bank), around)));
    }
    if (site.camera) {
        const ConfigNode options = TRY(optionsOf(*site.camera, backends));
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
    for (const Line& line : lines) {
        add(line.port);
        add(line.desk);
    }
    for (const auto& bank : relayBanks) add(bank);
    add(cueController);
    for (const auto& bank : contactBanks) add(bank);
    add(camera);
    return statuses;
}

}  // namespace fantascope::app
