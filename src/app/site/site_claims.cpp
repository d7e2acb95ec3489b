#include "app/site/site_claims.h"

#include "app/site/relay_guard.h"
#include "drivers/registry.h"

#include "show/patch.h"

#include "core/clock.h"
#include "core/log.h"

#include <fmt/format.h>

#include <filesystem>
#include <set>
#include <utility>

namespace fantascope::app {
namespace {

constexpr Time kLookAgain = std::chrono::milliseconds(20);
constexpr Time kLongestWait = RelayGuard::kPatience + std::chrono::seconds(10);

std::string claimOf(const show::Site& site) {
    std::error_code error;
    const auto file = std::filesystem::canonical(site.file, error);
    return "the site " + (error ? site.file : file).string();
}

}  // namespace

Error inUse(const std::string& what, const drivers::ClaimHolder& holder) {
    const std::string who = fmt::format("{} is in use by {}", what, holder.words());
    return Error(holder.process == 0 || holder.hasEnded() ? who
                                                          : fmt::format("{}. End that first: kill {}", who, holder.process));
}

Result<std::vector<DeclaredDevice>> declaredDevices(const show::Site& site) {
    std::vector<DeclaredDevice> devices;
    const auto add = [&](std::string name, const show::DeviceConfig& device, const auto& opening) {
        devices.push_back({std::move(name), device.driver, opening.claim});
    };
    for (const show::Universe& universe : site.universes) {
        const auto& [number, port, desk] = universe;
        add(fmt::format("universe {}", number), port, TRY(drivers::readDmxPort(port.options, number)));
        if (desk) add(fmt::format("desk {}", number), desk->device, TRY(drivers::readDmxSource(desk->device.options, number)));
    }
    for (std::size_t bank = 0; bank < site.relayBanks.size(); ++bank) {
        const auto& [name, device] = site.relayBanks[bank];
        add(name, device, TRY(drivers::readRelayBank(device.options, name, show::safeCoils(site, bank))));
    }
    if (const auto& device = site.cueController) add("cue controller", *device, TRY(drivers::readCueController(device->options)));
    for (std::size_t bank = 0; bank < site.contactBanks.size(); ++bank) {
        const auto& [name, device] = site.contactBanks[bank];
        add(name, device, TRY(drivers::readInputBank(device.options, name, site.inputCount(bank))));
    }
    if (const auto& device = site.camera) add("camera", *device, TRY(drivers::readCamera(device->options)));
    return devices;
}

Result<SiteClaims> SiteClaims::take(const show::Site& site, const Interrupt& interrupt) {
    // In a fixed order, so that one of two runs that start together gets all.
    std::set<std::string> ofDevices;
    for (const DeclaredDevice& device : TRY(declaredDevices(site))) ofDevices.insert(device.claim());
    for (const show::Output& output : site.outputs)
        ofDevices.insert(
            TRY(drivers::readDisplay(output.display.options, {output.name, output.size(), output.refreshRate})).claim());
    ofDevices.erase("");  // many programs may use it
    std::vector<std::string> names{claimOf(site)};
    names.insert(names.end(), ofDevices.begin(), ofDevices.end());
    SteadyClock clock;
    bool told = false;
    SiteClaims taken;
    for (const std::string& name : names) {
        auto claim = drivers::Claim::take(name);
        for (; !claim; claim = drivers::Claim::take(name)) {
            const auto holder = drivers::holderOf(name);
            if (!holder) continue;  // it has just gone
            if (!holder->hasEnded()) return inUse(name, *holder);
            if (interrupt.requested() || clock.now() > kLongestWait) return inUse(name, *holder);
            if (!std::exchange(told, true))
                log::info("app", fmt::format("{} is in use by {}, and makes its relays safe: waiting", name, holder->words()));
            clock.sleepUntil(clock.now() + kLookAgain);
        }
        taken.claims_.push_back(*std::move(claim));
    }
    return taken;
}

std::vector<int> SiteClaims::files() const {
    std::vector<int> files;
    for (const drivers::Claim& claim : claims_) files.push_back(claim.file());
    return files;
}

bool isClaimed(const show::Site& site, const DeclaredDevice& device) {
    if (drivers::isClaimed(claimOf(site))) return true;
    const std::string claim = device.claim();
    return !claim.empty() && drivers::isClaimed(claim);
}

std::optional<drivers::ClaimHolder> holderOf(const show::Site& site, const DeclaredDevice& device) {
    if (auto holder = drivers::holderOf(claimOf(site))) return holder;
    const std::string claim = device.claim();
    return claim.empty() ? std::nullopt : drivers::holderOf(claim);
}

}  // namespace fantascope::app
