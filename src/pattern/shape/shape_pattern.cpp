#include "pattern/shape/shape_pattern.h"

#include "core/geometry.h"

namespace fantascope::pattern {

std::size_t ShapePattern::triangleCount() const {
    std::size_t count = 0;
    for (const ShapeInstance& instance : instances) count += shapes[instance.shape].mesh.triangles.size();
    return count;
}

double ShapePattern::meanSize() const {
    double sum = 0;
    for (const ShapeInstance& instance : instances) sum += instance.size;
    return instances.empty() ? 0 : sum / static_cast<double>(instances.size());
}

GreyImage comparedGuide(GreyImage stored, GuideTransfer transfer, CompareSpace space) {
    if (space == CompareSpace::Light && transfer == GuideTransfer::Srgb)
        for (float& value : stored.pixels()) value = linearFromSrgb(value);
    return stored;
}

glm::dmat3 canvasFromShape(const InstancePose& pose) {
    const double s = pose.size;
    return glm::dmat3(s, 0, 0, 0, -s, 0, 0, 0, s) * rotationXyz(pose.rotation);
}

}  // namespace fantascope::pattern
