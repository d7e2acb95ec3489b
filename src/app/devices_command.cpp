#include "app/devices_command.h"

#include "app/device_trial.h"
#include "app/devices.h"
#include "app/interrupt.h"
#include "drivers/registry.h"

#include "show/patch.h"
#include "show/site.h"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <numeric>
#include <set>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;

struct Options {
    std::filesystem::path site, picture = "camera.png";
    bool watch = false;
    std::string test;
    std::optional<double> length;  // seconds
};

// What a lamp's address is tried with where no site says which there are.
constexpr std::size_t kSlotsWithoutFixtures = 16;

std::string lineOf(const drivers::FoundDevice& device) {
    std::string line = fmt::format("{:15} {}", device.family, device.what);
    for (const std::string& part : {device.identity, device.where})
        if (!part.empty()) line += ", " + part;
    if (!device.why.empty()) line += fmt::format("\n{:15} cannot be used: {}", "", device.why);
    if (!device.options.empty()) line += fmt::format("\n{:15} {}", "", device.options);
    return line;
}

std::string lineOf(const DeviceStatus& status) {
    std::string line = fmt::format("{:15} {}, {}", status.name, status.driver, nameOf(status.state));
    if (!status.detail.empty()) line += ": " + status.detail;
    return line;
}

// The outputs' projectors, by their identity.
Result<std::vector<DeviceStatus>> projectorsOf(const show::Site& site) {
    std::vector<drivers::DisplayQuestion> questions;
    for (const show::Output& output : site.outputs)
        questions.push_back({output.display.options, {output.name, output.size(), output.refreshRate}});
    return drivers::lookForDisplays(questions);
}

// Everything of a site but its outputs: those would cover the screen that this is read on.
Result<Devices> openAllButOutputs(show::Site site, Clock& clock) {
    site.outputs.clear();
    return openDevices(site, Backends::AsDeclared, {clock});
}

// Until every device has been looked for once.
void waitForFirstLook(const Devices& devices, Clock& clock, const Interrupt& interrupt) {
    const auto isStarting = [&] {
        const auto statuses = devices.statuses();
        return std::any_of(statuses.begin(), statuses.end(),
                           [](const DeviceStatus& status) { return status.state == DeviceState::Starting; });
    };
    for (const Time latest = clock.now() + 5s; isStarting() && clock.now() < latest && !interrupt.requested();)
        clock.sleepUntil(clock.now() + 20ms);
}

Result<void> list(const std::optional<show::Site>& site) {
    SteadyClock clock;
    const Interrupt interrupt;
    const auto found = drivers::findDevices();
    for (const drivers::FoundDevice& device : found) fmt::print("{}\n", lineOf(device));
    if (found.empty())
        fmt::print("no device was found: nothing on USB, no serial line, no camera, no monitor, no node on the network\n");
    if (!site) return {};
    fmt::print("\n{}:\n", site->file.string());
    const Devices devices = TRY(openAllButOutputs(*site, clock));
    waitForFirstLook(devices, clock, interrupt);
    for (const DeviceStatus& status : TRY(projectorsOf(*site))) fmt::print("{}\n", lineOf(status));
    for (const DeviceStatus& status : devices.statuses()) fmt::print("{}\n", lineOf(status));
    return {};
}

// Tells what comes and goes until it is interrupted.
Result<void> watch(const std::optional<show::Site>& site, Time length) {
    SteadyClock clock;
    const Interrupt interrupt;
    Devices devices;
    if (site) devices = TRY(openAllButOutputs(*site, clock));
    std::set<std::string> there;
    std::map<std::string, std::string> said;
    fmt::print("what comes and goes; Ctrl-C ends\n");
    for (const Time end = clock.now() + length; clock.now() < end && !interrupt.requested();
         clock.sleepUntil(clock.now() + 200ms)) {
        std::set<std::string> now;
        for (const drivers::FoundDevice& device : drivers::findDevices()) now.insert(lineOf(device));
        for (const std::string& line : now)
            if (!there.contains(line)) fmt::print("+ {}\n", line);
        for (const std::string& line : there)
            if (!now.contains(line)) fmt::print("- {}\n", line.substr(0, line.find('\n')));
        there = std::move(now);
        std::vector<DeviceStatus> statuses = devices.statuses();
        if (site)
            for (DeviceStatus& status : TRY(projectorsOf(*site))) statuses.push_back(std::move(status));
        for (const DeviceStatus& status : statuses)
            if (std::string line = lineOf(status); said[status.name] != line)
                fmt::print("  {}\n", said[status.name] = std::move(line));
        std::fflush(stdout);
    }
    return {};
}

std::vector<std::size_t> slotsOf(const show::Site& site, int universe) {
    std::vector<std::size_t> slots;
    for (const show::Fixture& fixture : site.fixtures)
        for (std::size_t channel = 0; channel < fixture.channels.size(); ++channel)
            if (fixture.universe == universe) slots.push_back(static_cast<std::size_t>(fixture.address) - 1 + channel);
    return slots;
}

std::vector<std::size_t> firstSlots() {
    std::vector<std::size_t> slots(kSlotsWithoutFixtures);
    std::iota(slots.begin(), slots.end(), std::size_t{0});
    return slots;
}

// A device of the site, by the name that its status has.
Result<void> testDeclared(const Options& options, const show::Site& site, DeviceTrial& trial, Clock& clock) {
    const drivers::Surroundings around{clock};
    std::vector<std::string> names;
    const auto isIt = [&](const std::string& name) {
        names.push_back(name);
        return name == options.test;
    };
    for (const show::Universe& universe : site.universes)
        if (isIt(fmt::format("universe {}", universe.number))) {
            const auto port = TRY(drivers::openDmxPort(universe.port.options, universe.number, around));
            const auto slots = slotsOf(site, universe.number);
            return trial.chase(*port, slots.empty() ? firstSlots() : slots);
        }
    for (const show::Universe& universe : site.universes)
        if (universe.desk && isIt(fmt::format("desk {}", universe.number)))
            return trial.tellDesk(*TRY(drivers::openDmxSource(universe.desk->device.options, universe.number, around)));
    for (std::size_t bank = 0; bank < site.relayBanks.size(); ++bank)
        if (const auto& [name, device] = site.relayBanks[bank]; isIt(name)) {
            const auto safe = show::safeCoils(site, bank);
            return trial.click(*TRY(drivers::openRelayBank(device.options, name, safe, around)), safe);
        }
    if (site.cueController && isIt("cue controller"))
        return trial.tellPresses(*TRY(drivers::openCueController(site.cueController->options, around)));
    for (std::size_t bank = 0; bank < site.contactBanks.size(); ++bank)
        if (const auto& [name, device] = site.contactBanks[bank]; isIt(name))
            return trial.tellContacts(*TRY(drivers::openInputBank(device.options, name, site.inputCount(bank), around)));
    if (site.camera && isIt("camera"))
        return trial.snapshot(*TRY(drivers::openCamera(site.camera->options, around)), options.picture);
    for (const show::Output& output : site.outputs)
        if (output.name == options.test)
            return Error(
                fmt::format("'{}' is an output: run a show on the site and press e there for its test pictures "
                            "(docs/setting-up.md)",
                            output.name));
    return Error(fmt::format("{} has no device '{}'; it has {}", site.file.string(), options.test, listed(names)));
}

// A device that was found, by where it is, what it is, or its identity.
Result<void> testFound(const Options& options, DeviceTrial& trial, Clock& clock) {
    const drivers::Surroundings around{clock};
    const auto found = drivers::findDevices();
    std::vector<std::string> names;
    for (const drivers::FoundDevice& device : found) {
        names.push_back(device.where.empty() ? device.identity : device.where);
        const auto names = [&](const std::string& text) { return !text.empty() && text.find(options.test) != std::string::npos; };
        if (!names(device.where) && !names(device.identity) && !names(device.what)) continue;
        if (!device.why.empty()) return Error(device.why);
        const ConfigNode node = TRY(ConfigNode::parse(device.options, "the device that was found"));
        if (device.family == "dmx") return trial.chase(*TRY(drivers::openDmxPort(node, 1, around)), firstSlots());
        if (device.family == "cue_controller") return trial.tellPresses(*TRY(drivers::openCueController(node, around)));
        if (device.family == "camera") return trial.snapshot(*TRY(drivers::openCamera(node, around)), options.picture);
        return Error(fmt::format("how a device of the family {} is used stands in a site file: add --site", device.family));
    }
    return Error(fmt::format("no device '{}' was found; there is {}", options.test, names.empty() ? "none" : listed(names)));
}

Result<void> devices(const Options& options) {
    std::optional<show::Site> site;
    if (!options.site.empty()) {
        const bool isFolder = std::filesystem::is_directory(options.site);
        site = TRY(show::readSite(isFolder ? options.site / "site.yaml" : options.site));
    }
    constexpr double kTrial = 10, kForever = 1e8;
    if (!options.test.empty()) {
        SteadyClock clock;
        const Interrupt interrupt;
        DeviceTrial trial(clock, fromSeconds(options.length.value_or(kTrial)), &interrupt, std::cout);
        return site ? testDeclared(options, *site, trial, clock) : testFound(options, trial, clock);
    }
    if (options.watch) return watch(site, fromSeconds(options.length.value_or(kForever)));
    return list(site);
}

void declare(CLI::App& command, Options& options) {
    command.add_option("--site", options.site, "say of this site's devices how they are: a folder or a site.yaml");
    CLI::Option* watches = command.add_flag("--watch", options.watch, "go on, and tell what comes and goes");
    command
        .add_option(
            "--test", options.test,
            "try one device: of the site by its name ('universe 1', 'desk 1', 'cue controller', 'camera', or a bank's own), "
            "or one that was found by a part of its line. Lamps chase, relays click, presses are told, a camera leaves a picture")
        ->excludes(watches);
    command.add_option("--seconds", options.length, "how long (default: a test 10 s)")->check(CLI::Range(0.1, 1e6));
    command.add_option("-o,--output", options.picture, "where a camera's picture goes")->capture_default_str();
}

}  // namespace

void addDevicesCommand(CLI::App& program, Action& action) {
    addCommand<Options>(program, action, "devices", "What is there: widgets, nodes, relays, controllers, cameras, projectors",
                        declare, devices);
}

}  // namespace fantascope::app
