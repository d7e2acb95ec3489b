#pragma once

#include "app/lens/lens_camera.h"

#include <cstdint>
#include <memory>

namespace fantascope::app {

// The site's camera in a simulated room by day, where a hand holds the lens board before it, at one
// place and tilt after the other, a few frames each. Its lens is the one in the site file, its
// noise and blur those of the `simulation` section, the exposure fits the board. The same seed
// gives the same frames.
// Error: the site has no `simulation` section; the scene cannot be made.
Result<std::unique_ptr<LensCamera>> simulatedHand(const show::Site& site, std::uint64_t seed);

}  // namespace fantascope::app
