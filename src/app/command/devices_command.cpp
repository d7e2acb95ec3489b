#include "app/base/interrupt.h"
#include "app/command/commands.h"
#include "app/command/device_trial.h"
#include "app/lens/lens_file.h"
#include "app/site/devices.h"
#include "app/site/relay_guard.h"
#include "app/site/site_claims.h"
#include "app/site/site_file.h"
#include "drivers/registry.h"

#include "show/patch.h"
#include "show/site/site.h"

#include "core/text.h"

#include <fmt/format.h>
#include <unistd.h>

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
    bool yes = false;
    std::optional<double> length;  // seconds
};

// The slots to try if no site says which ones there are.
constexpr std::size_t kSlotsWithoutFixtures = 16;

std::string lineOf(const drivers::FoundDevice& device) {
    std::string line = fmt::format("{:15} {}", device.family, device.what);
    for (const std::string& part : {device.identity, device.where})
        if (!part.empty()) line += ", " + part;
    if (!device.why.empty()) line += fmt::format("\n{:15} cannot be used: {}", "", device.why);
    if (!device.options.empty()) line += fmt::format("\n{:15} {}", "", device.options);
    return printableLines(line);  // devices choose their names
}

std::string lineOf(const DeviceStatus& status) {
    std::string line = fmt::format("{:15} {}, {}", status.name, status.driver, nameOf(status.state));
    for (const std::string& words : {status.detail, status.trouble})
        if (!words.empty()) line += ": " + words;
    return printableLines(line);
}

// More lines about the site's camera: what it gives, what it cannot do of what the site file asks,
// and whether the lens is its own.
std::string moreOf(const show::Site& site, const CameraDescription& camera) {
    std::string lines;
    const auto add = [&](const std::string& words) {
        if (!words.empty()) lines += fmt::format("\n{:15} {}", "", printableLines(words));
    };
    if (!camera.format.empty()) add(fmt::format("{}: {}", identityOf(camera), camera.format));
    if (!camera.lacks.empty()) add("of the site file's settings, " + camera.lacks);
    add(lensMismatch(site, camera));
    return lines;
}

// The outputs' projectors, by their identity.
Result<std::vector<DeviceStatus>> projectorsOf(const show::Site& site) {
    std::vector<drivers::DisplayQuestion> questions;
    for (const show::Output& output : site.outputs)
        questions.push_back({output.display.options, {output.name, output.size(), output.refreshRate}});
    return drivers::lookForDisplays(questions);
}

// Removes the banks of these names from a site, with what is connected to them.
template <class Member>
void removeBanks(std::vector<show::Bank>& banks, std::vector<Member>& members, const std::set<std::string>& names) {
    for (std::size_t bank = banks.size(); bank-- > 0;) {
        if (!names.contains(banks[bank].name)) continue;
        banks.erase(banks.begin() + static_cast<std::ptrdiff_t>(bank));
        std::erase_if(members, [&](const Member& member) { return member.bank == bank; });
        for (Member& member : members)
            if (member.bank > bank) --member.bank;
    }
}

// The site without these devices and without its outputs: they would cover the screen on which a
// person reads this.
show::Site without(const std::set<std::string>& names, show::Site site) {
    site.outputs.clear();
    std::erase_if(site.universes, [&](show::Universe& universe) {
        if (names.contains(fmt::format("desk {}", universe.number))) universe.desk.reset();
        return names.contains(fmt::format("universe {}", universe.number));
    });
    removeBanks(site.relayBanks, site.relays, names);
    removeBanks(site.contactBanks, site.contacts, names);
    if (names.contains("cue controller")) site.cueController.reset();
    if (names.contains("camera")) site.camera.reset();
    return site;
}

// Watches the devices of a site. It does not touch what another program has. It opens the rest, and
// never writes to them.
class Look {
public:
    Look(show::Site site, std::vector<DeclaredDevice> declared, Clock& clock)
        : site_(std::move(site)), declared_(std::move(declared)), clock_(clock) {}
    // Opens devices that have become free, and closes those that another program has claimed.
    Result<void> refresh() {
        std::set<std::string> held;
        for (const DeclaredDevice& device : declared_)
            if (isClaimed(site_, device)) held.insert(device.name);
        if (opened_ && held == held_) return {};
        held_ = std::move(held);
        devices_ = {};
        devices_ = TRY(openDevices(without(held_, site_), Backends::AsDeclared, {clock_}));
        lines_.clear();
        for (const DeclaredDevice& device : declared_)
            if (held_.contains(device.name))
                if (const auto holder = holderOf(site_, device))
                    lines_[device.name] = fmt::format("{:15} {}, in use by {}", device.name, device.driver, holder->words());
        opened_ = true;
        return {};
    }
    const Devices& devices() const { return devices_; }
    // A line for each device, by its name.
    std::map<std::string, std::string> lines() const {
        std::map<std::string, std::string> lines = lines_;
        for (const DeviceStatus& status : devices_.statuses()) lines[status.name] = lineOf(status);
        if (devices_.camera) lines["camera"] += moreOf(site_, devices_.camera->description());
        return lines;
    }
    // In the site's order.
    std::vector<std::string> names() const {
        std::vector<std::string> names;
        for (const DeclaredDevice& device : declared_) names.push_back(device.name);
        return names;
    }

private:
    const show::Site site_;
    const std::vector<DeclaredDevice> declared_;
    Clock& clock_;
    bool opened_ = false;
    std::set<std::string> held_;
    Devices devices_;
    std::map<std::string, std::string> lines_;  // of devices that another program has
};

// Waits until every device has been looked for once.
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
    Look look(*site, TRY(declaredDevices(*site)), clock);
    TRY(look.refresh());
    waitForFirstLook(look.devices(), clock, interrupt);
    for (const DeviceStatus& status : TRY(projectorsOf(*site))) fmt::print("{}\n", lineOf(status));
    auto lines = look.lines();
    for (const std::string& name : look.names()) fmt::print("{}\n", lines[name]);
    return {};
}

// Prints what is plugged and unplugged until it is interrupted.
Result<void> watch(const std::optional<show::Site>& site, Time length) {
    SteadyClock clock;
    const Interrupt interrupt;
    std::optional<Look> look;
    if (site) look.emplace(*site, TRY(declaredDevices(*site)), clock);
    std::set<std::string> there;
    std::map<std::string, std::string> said;
    fmt::print("+ plugged, - unplugged; Ctrl-C ends\n");
    for (const Time end = clock.now() + length; clock.now() < end && !interrupt.requested();
         clock.sleepUntil(clock.now() + 200ms)) {
        std::set<std::string> now;
        for (const drivers::FoundDevice& device : drivers::findDevices()) now.insert(lineOf(device));
        for (const std::string& line : now)
            if (!there.contains(line)) fmt::print("+ {}\n", line);
        for (const std::string& line : there)
            if (!now.contains(line)) fmt::print("- {}\n", line.substr(0, line.find('\n')));
        there = std::move(now);
        std::map<std::string, std::string> lines;
        if (site) {
            TRY(look->refresh());
            lines = look->lines();
            for (const DeviceStatus& status : TRY(projectorsOf(*site))) lines[status.name] = lineOf(status);
        }
        for (auto& [name, line] : lines)
            if (said[name] != line) fmt::print("  {}\n", said[name] = std::move(line));
        std::fflush(stdout);
    }
    return {};
}

// "sculpture intensity" for each slot that has a fixture.
DeviceTrial::Names slotNames(const show::Site& site, int universe) {
    DeviceTrial::Names names;
    for (const show::Fixture& fixture : site.fixtures)
        for (std::size_t channel = 0; channel < fixture.channels.size(); ++channel)
            if (fixture.universe == universe)
                names[static_cast<std::size_t>(fixture.address) - 1 + channel] = fixture.name + " " + fixture.channels[channel];
    return names;
}

DeviceTrial::Names relayNames(const show::Site& site, std::size_t bank) {
    DeviceTrial::Names names;
    for (const show::Relay& relay : site.relays)
        if (relay.bank == bank) names[static_cast<std::size_t>(relay.coil)] = relay.name;
    return names;
}

DeviceTrial::Names contactNames(const show::Site& site, std::size_t bank) {
    DeviceTrial::Names names;
    for (const show::Contact& contact : site.contacts)
        if (contact.bank == bank) names[static_cast<std::size_t>(contact.input)] = contact.name;
    return names;
}

DeviceTrial::Names buttonNames(const show::Site& site) {
    DeviceTrial::Names names;
    for (const auto& [number, button, list] : site.buttons)
        names[static_cast<std::size_t>(number)] =
            list.empty() ? std::string(show::nameOf(button)) : fmt::format("{} of {}", show::nameOf(button), list);
    return names;
}

std::vector<std::size_t> firstSlots() {
    std::vector<std::size_t> slots(kSlotsWithoutFixtures);
    std::iota(slots.begin(), slots.end(), std::size_t{0});
    return slots;
}

// Claims the device under test, so that the test does not interfere with a show. Error: another
// program has it.
Result<std::optional<drivers::Claim>> claimForTest(const std::string& name, const std::string& claim) {
    if (claim.empty()) return std::optional<drivers::Claim>();
    auto taken = drivers::Claim::take(claim);
    if (taken) return taken;
    const auto holder = drivers::holderOf(claim);
    return inUse(name, holder.value_or(drivers::ClaimHolder()));
}
Result<std::optional<drivers::Claim>> claimForTest(const std::string& name, const show::Site& site) {
    for (const DeclaredDevice& device : TRY(declaredDevices(site))) {
        if (device.name != name) continue;
        if (const auto holder = holderOf(site, device)) return inUse(name, *holder);
        return claimForTest(name, device.claim());
    }
    return std::optional<drivers::Claim>();
}

// Tries a device of the site, by the name in its status.
Result<void> testDeclared(const Options& options, const show::Site& site, const std::optional<drivers::Claim>& claim,
                          DeviceTrial& trial, Clock& clock) {
    const drivers::DriverContext context{clock};
    std::vector<std::string> names;
    const auto isIt = [&](const std::string& name) {
        names.push_back(name);
        return name == options.test;
    };
    for (const show::Universe& universe : site.universes)
        if (isIt(fmt::format("universe {}", universe.number))) {
            const auto port = TRY(drivers::openDmxPort(universe.port.options, universe.number, context));
            const auto names = slotNames(site, universe.number);
            std::vector<std::size_t> slots;
            for (const auto& [slot, name] : names) slots.push_back(slot);
            return trial.chase(*port, slots.empty() ? firstSlots() : slots, names);
        }
    for (const show::Universe& universe : site.universes)
        if (universe.desk && isIt(fmt::format("desk {}", universe.number)))
            return trial.tellDesk(*TRY(drivers::openDmxSource(universe.desk->device.options, universe.number, context)),
                                  slotNames(site, universe.number));
    for (std::size_t bank = 0; bank < site.relayBanks.size(); ++bank)
        if (const auto& [name, device] = site.relayBanks[bank]; isIt(name)) {
            const auto safe = show::safeCoils(site, bank);
            const auto guard = TRY(RelayGuard::start(site, claim ? std::vector{claim->file()} : std::vector<int>(), name));
            return trial.click(*TRY(drivers::openRelayBank(device.options, name, safe, context)), safe, relayNames(site, bank),
                               guard.get());
        }
    if (site.cueController && isIt("cue controller"))
        return trial.tellPresses(*TRY(drivers::openCueController(site.cueController->options, context)), buttonNames(site));
    for (std::size_t bank = 0; bank < site.contactBanks.size(); ++bank)
        if (const auto& [name, device] = site.contactBanks[bank]; isIt(name))
            return trial.tellContacts(*TRY(drivers::openInputBank(device.options, name, site.inputCount(bank), context)),
                                      contactNames(site, bank));
    if (site.camera && isIt("camera"))
        return trial.snapshot(*TRY(drivers::openCamera(site.camera->options, context)), options.picture);
    for (const show::Output& output : site.outputs)
        if (output.name == options.test)
            return Error(
                fmt::format("'{}' is an output: run a show on the site, and press e for its test pictures "
                            "(docs/setting-up.md)",
                            output.name));
    return Error(fmt::format("{} has no device '{}'; it has {}", site.file.string(), options.test, listed(names)));
}

// Tries a device that was found, by its place, its kind or its identity.
Result<void> testFound(const Options& options, DeviceTrial& trial, Clock& clock) {
    const drivers::DriverContext context{clock};
    const auto found = drivers::findDevices();
    std::vector<std::string> names;
    for (const drivers::FoundDevice& device : found) {
        names.push_back(device.where.empty() ? device.identity : device.where);
        const auto names = [&](const std::string& text) { return !text.empty() && text.find(options.test) != std::string::npos; };
        if (!names(device.where) && !names(device.identity) && !names(device.what)) continue;
        if (!device.why.empty()) return Error(device.why);
        const ConfigNode node = TRY(ConfigNode::parse(device.options, "the device that was found"));
        const auto alone = [&](const auto& opening, const auto& tryIt) -> Result<void> {
            const auto claim = TRY(claimForTest(device.what, opening.claim()));
            return tryIt(*TRY(opening.open(context)));
        };
        if (device.family == "dmx")
            return alone(TRY(drivers::readDmxPort(node, 1)), [&](DmxPort& port) { return trial.chase(port, firstSlots()); });
        if (device.family == "cue_controller")
            return alone(TRY(drivers::readCueController(node)),
                         [&](CueController& controller) { return trial.tellPresses(controller); });
        if (device.family == "camera")
            return alone(TRY(drivers::readCamera(node)),
                         [&](CameraSource& camera) { return trial.snapshot(camera, options.picture); });
        return Error(fmt::format("a device of the family {} can only be tried with a site file: add --site", device.family));
    }
    return Error(fmt::format("no device '{}' was found; there is {}", options.test, names.empty() ? "none" : listed(names)));
}

// A trial of relays switches what is connected to them, so somebody must agree.
Result<void> askBeforeClicking(const Options& options, const show::Site& site) {
    std::vector<std::string> relays;
    for (const show::Relay& relay : site.relays)
        if (site.relayBanks[relay.bank].name == options.test) relays.push_back(relay.name);
    if (relays.empty() || options.yes) return {};
    const std::string what = fmt::format("this test switches {}, one after the other", listed(relays));
    if (isatty(STDIN_FILENO) == 0) return Error(what + ": add --yes to allow it");
    fmt::print("{}. Begin? y and Enter: ", what);
    std::fflush(stdout);
    std::string answer;
    std::getline(std::cin, answer);
    if (answer != "y") return Error("no relay was switched");
    return {};
}

Result<void> devices(const Options& options) {
    std::optional<show::Site> site;
    if (!options.site.empty()) site = TRY(readSite(options.site));
    constexpr double kTrial = 10, kForever = 1e8;
    if (!options.test.empty()) {
        std::optional<drivers::Claim> claim;
        if (site) {
            claim = TRY(claimForTest(options.test, *site));
            TRY(askBeforeClicking(options, *site));
        }
        SteadyClock clock;
        const Interrupt interrupt(Interrupt::Second::IsCounted);  // no fixture stays lit, no relay unsafe
        DeviceTrial trial(clock, fromSeconds(options.length.value_or(kTrial)), &interrupt, std::cout);
        return site ? testDeclared(options, *site, claim, trial, clock) : testFound(options, trial, clock);
    }
    if (options.watch) return watch(site, fromSeconds(options.length.value_or(kForever)));
    return list(site);
}

void declare(Command& command, Options& options) {
    command.add("--site", options.site, "report the state of this site's devices: a folder or a site.yaml");
    const Option watches = command.addFlag("--watch", options.watch, "keep running, and report what is plugged and unplugged");
    command
        .add(
            "--test", options.test,
            "try one device: one of the site by its name ('universe 1', 'desk 1', 'cue controller', 'camera', or a bank's name), "
            "or a found one by a part of its line. Fixtures chase, relays click, presses are printed, a camera leaves a picture")
        .excludes(watches);
    command.addFlag("--yes", options.yes, "switch relays in a test without asking");
    command.add("--seconds", options.length, "end after this time (default for a test: 10 s)").range(0.1, 1e6);
    addOutOption(command, options.picture, "file for a camera's picture").showDefault();
}

}  // namespace

void addDevicesCommand(Program& program) {
    addCommand<Options>(program, "devices",
                        "List the devices that are found: projectors, DMX widgets and nodes, relays, hand controllers, cameras",
                        declare, devices);
}

}  // namespace fantascope::app
