#include "pattern/shape_pattern.h"

#include "core/geometry.h"

namespace fantascope::pattern {

glm::dmat3 canvasFromShape(const InstancePose& pose) {
    const double s = pose.size;
    return glm::dmat3(s, 0, 0, 0, -s, 0, 0, 0, s) * rotationXyz(pose.rotation);
}

}  // namespace fantascope::pattern
