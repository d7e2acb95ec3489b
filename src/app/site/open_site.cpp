#include "app/site/open_site.h"

#include "app/site/site_models.h"

#include <fmt/format.h>

#include <algorithm>

namespace fantascope::app {

Result<std::unique_ptr<OpenSite>> OpenSite::open(const show::Site& site, Backends backends, std::uint64_t seed, Clock& clock) {
    auto opened = std::make_unique<OpenSite>(clock);
    const bool simulated = backends != Backends::AsDeclared;
    if (simulated) {
        if (!site.simulation)
            return Error(fmt::format("{}: has no 'simulation' section, so it cannot be rehearsed; see docs/site-format.md",
                                     site.file.string()));
        opened->simulation = TRY(site::SimulatedSite::open(*site.simulation, TRY(simulationOf(site)), seed, opened->world));
    }
    opened->devices = TRY(openDevices(site, backends, {clock, simulated ? &opened->world : nullptr}));
    return opened;
}

bool OpenSite::pressGo(const show::Site& site) {
    const auto go = std::ranges::find(site.buttons, show::Button::Go, &show::SiteButton::button);  // the main list's comes first
    if (!simulation || !devices.cueController || go == site.buttons.end()) return false;
    for (const bool pressed : {true, false}) world.press(go->number, pressed);
    return true;
}

}  // namespace fantascope::app
