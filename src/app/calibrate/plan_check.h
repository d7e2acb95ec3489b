#pragma once

#include "show/site/site.h"
#include "vision/structured_light.h"

#include "core/result.h"
#include "core/warp.h"

#include <cstddef>
#include <optional>

namespace fantascope::app {

// Whether the camera sees an output's picture turned by half a turn from what the site file says of
// projector, surface and camera. Nothing: it does not say where they are, or says that the
// projector turns or mirrors its picture. Error: as cameraOf()'s.
Result<std::optional<bool>> isUpsideDown(const show::Site& site, std::size_t output, const vision::ProjectorMap& seen);

// Whether a warp shows the canvas turned by half a turn from how another one does.
bool isHalfTurned(const WarpShape& warp, const WarpShape& other);

}  // namespace fantascope::app
