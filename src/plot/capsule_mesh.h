#pragma once

#include "theatre/posed_body.h"

#include "core/mesh.h"

#include <span>

namespace fantascope::plot {

// The capsules as one mesh of closed, smooth pieces that may reach into each other. Metres, stage frame.
TriangleMesh capsuleMesh(std::span<const theatre::PlacedCapsule> capsules);

}  // namespace fantascope::plot
