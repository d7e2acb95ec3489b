#pragma once

#include "app/site/devices.h"
#include "drivers/site/simulated_site.h"
#include "drivers/site/world.h"

#include "show/site/site.h"

#include "core/clock.h"
#include "core/result.h"

#include <cstdint>
#include <memory>

namespace fantascope::app {

// A site with its devices open, and the simulated site around them where they are simulated.
struct OpenSite {
    site::World world;
    std::unique_ptr<site::SimulatedSite> simulation;  // null: real devices
    Devices devices;

    // `seed`: of the simulated site's noise. Error: as openDevices(), or the site cannot be
    // simulated.
    static Result<std::unique_ptr<OpenSite>> open(const show::Site& site, Backends backends, std::uint64_t seed, Clock& clock);
    explicit OpenSite(const Clock& clock) : world(clock) {}

    // Presses GO on the simulated hand controller. False: there is none.
    bool pressGo(const show::Site& site);
};

}  // namespace fantascope::app
