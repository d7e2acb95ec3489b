#include "app/site/devices.h"

#include "drivers/registry.h"

#include "show/patch.h"

namespace fantascope::app {
namespace {

// A driver without any keys, in place of the declared one.
Result<ConfigNode> plain(const std::string& driver, const show::DeviceConfig& declared) {
    return ConfigNode::parse("driver: " + driver + "\n", declared.options.file());
}

// The declared options, or those of the simulated driver.
Result<ConfigNode> optionsOf(const show::DeviceConfig& declared, Backends backends) {
    constexpr const char* kSimulated = "simulated";
    if (backends == Backends::AsDeclared || declared.driver == kSimulated) return declared.options;
    return plain(kSimulated, declared);
}

// For a display. A rehearsal has none of the site's monitors, so no keys are kept, even of the same
// driver.
Result<ConfigNode> displayOptions(const show::DeviceConfig& declared, Backends backends) {
    if (backends == Backends::AsDeclared) return declared.options;
    return plain(backends == Backends::SimulatedWindows ? "glfw" : "headless", declared);
}

// What the drivers have read of a site's devices.
struct Openings {
    std::vector<drivers::Opening<DisplaySink>> displays;
    std::vector<drivers::Opening<DmxPort>> ports;
    std::vector<drivers::Opening<DmxSource>> desks;  // of the universes that have one, in their order
    std::vector<drivers::Opening<RelayBank>> relayBanks;
    std::vector<drivers::Opening<CueController>> controllers;
    std::vector<drivers::Opening<InputBank>> contactBanks;
    std::vector<drivers::Opening<CameraSource>> cameras;
};

// Error: every fault of every device.
Result<Openings> readDevices(const show::Site& site, Backends backends, const drivers::DriverContext& context) {
    Openings all;
    ConfigFaults faults;
    const auto read = [&](auto opening, const ConfigNode& options, auto& ofPort) {
        faults.take(std::move(opening), [&](auto good) {
            if (good.simulated && context.world == nullptr)
                faults.add(options.error(
                    "driver 'simulated' needs a simulated site, and there is none; rehearse, or name a real driver"));
            ofPort.push_back(std::move(good));
        });
    };
    for (const show::Output& output : site.outputs) {
        const ConfigNode options = TRY(displayOptions(output.display, backends));
        read(drivers::readDisplay(options, {output.name, output.size(), output.refreshRate}), options, all.displays);
    }
    for (const show::Universe& universe : site.universes) {
        const ConfigNode options = TRY(optionsOf(universe.port, backends));
        read(drivers::readDmxPort(options, universe.number), options, all.ports);
        if (!universe.desk) continue;
        const ConfigNode desk = TRY(optionsOf(universe.desk->device, backends));
        read(drivers::readDmxSource(desk, universe.number), desk, all.desks);
    }
    for (std::size_t bank = 0; bank < site.relayBanks.size(); ++bank) {
        const ConfigNode options = TRY(optionsOf(site.relayBanks[bank].device, backends));
        read(drivers::readRelayBank(options, site.relayBanks[bank].name, show::safeCoils(site, bank)), options, all.relayBanks);
    }
    if (site.cueController) {
        const ConfigNode options = TRY(optionsOf(*site.cueController, backends));
        read(drivers::readCueController(options), options, all.controllers);
    }
    for (std::size_t bank = 0; bank < site.contactBanks.size(); ++bank) {
        const ConfigNode options = TRY(optionsOf(site.contactBanks[bank].device, backends));
        read(drivers::readInputBank(options, site.contactBanks[bank].name, site.inputCount(bank)), options, all.contactBanks);
    }
    if (site.camera) {
        const ConfigNode options = TRY(optionsOf(*site.camera, backends));
        read(drivers::readCamera(options), options, all.cameras);
    }
    TRY(faults.result());
    return all;
}

}  // namespace

Result<Devices> openDevices(const show::Site& site, Backends backends, const drivers::DriverContext& context) {
    // All are read before the first is opened, so that a fault in any is reported before anything
    // lights up.
    const Openings all = TRY(readDevices(site, backends, context));
    Devices devices;
    for (const auto& display : all.displays) devices.displays.push_back(TRY(display.open(context)));
    auto desk = all.desks.begin();
    for (std::size_t i = 0; i < site.universes.size(); ++i) {
        auto port = TRY(all.ports[i].open(context));
        Devices::Line line{site.universes[i].number, std::move(port), nullptr};
        if (site.universes[i].desk) line.desk = TRY((desk++)->open(context));
        devices.lines.push_back(std::move(line));
    }
    for (const auto& bank : all.relayBanks) devices.relayBanks.push_back(TRY(bank.open(context)));
    for (const auto& controller : all.controllers) devices.cueController = TRY(controller.open(context));
    for (const auto& bank : all.contactBanks) devices.contactBanks.push_back(TRY(bank.open(context)));
    for (const auto& camera : all.cameras) devices.camera = TRY(camera.open(context));
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
