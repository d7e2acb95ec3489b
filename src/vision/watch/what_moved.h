#pragma once

#include "vision/watch/drift_track.h"
#include "vision/watch/wall_watch.h"

#include <optional>
#include <vector>

namespace fantascope::vision {

// What stands elsewhere when pictures have moved in the camera's view.
enum class Moved {
    Nothing,
    Projectors,  // those whose drifts are sure
    Camera,
    Unclear  // a projector or the camera: the view does not tell
};

// Decides what moved. `drifts`: by output, how far its picture moved since nothing was amiss;
// nothing: the output says nothing now. A camera moves all pictures together, and the surface with
// them. A projector moves its own picture only, and the surface stays.
Moved whatMoved(const WallWatch& wall, const std::vector<std::optional<Drift>>& drifts);

}  // namespace fantascope::vision
