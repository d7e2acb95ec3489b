#pragma once

#include "vision/watch/wall_watch.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace fantascope::vision {

// Why the wall does not look as it should.
enum class Cause {
    OutOfFocus,
    DimLamp,
    DeadOutput,
    WrongInput,
    BlockedView,
    Fog,
    AmbientLight,
    CameraDirty,
    CameraBlind,
    CameraExposure,
    CameraElsewhere  // no picture is where it belongs: the camera looks at something else
};

struct NamedCause {
    Cause cause = Cause::OutOfFocus;
    std::optional<std::size_t> output;  // nothing: all of them
    // What was measured: the blur in camera pixels, the share of the usual light, the share of the
    // picture that is hidden, or the other light as a share of full light.
    double figure = 0;
};

// Tells causes apart by what one measurement says. A projector's fault changes its own picture
// only. Fog weakens all pictures and lights up what is dark. The camera's exposure changes
// everything alike. What hides a part of the view leaves the rest as usual. One output alone shows
// less: then the surroundings, and the surface's texture, decide.
std::vector<NamedCause> causesOf(const WallLight& light);

}  // namespace fantascope::vision
