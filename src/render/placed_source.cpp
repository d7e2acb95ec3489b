#include "render/placed_source.h"

#include "core/check.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace fantascope::render {
namespace {

// The direction towards the light that shades facets, in the canvas's frame (x right, y down, z to
// the viewer): above, a little left, in front.
const glm::dvec3 kTowardsLight = glm::normalize(glm::dvec3(-0.4, -0.6, 0.7));

}  // namespace

PlacedSource::PlacedSource(const PatternSource& source, const CanvasPlace& place) : source_(source) {
    FANTASCOPE_CHECK(source.pattern != nullptr, "a pattern source has a pattern");
    follow(place);
    const auto& instances = source_.pattern->instances;
    for (const pattern::ShapeInstance& instance : instances)
        poses_.push_back({instance.centre, instance.size, instance.rotation});
    order_.resize(instances.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::size_t a, std::size_t b) { return instances[a].shape < instances[b].shape; });
}

void PlacedSource::follow(const CanvasPlace& place) {
    clipFromCanvas_ = clipFromCanvas(source_.pattern->aspect(), place);
    // A homography H maps the line e, dot(e, (x, y, 1)) = 0, to inverse(H)^T e.
    const glm::dmat3 clipFromEdge = glm::transpose(glm::inverse(clipFromPicture(place)));
    const auto [low, high] = shownInPicture(place);
    const std::array<glm::dvec3, 4> edges = {{{1, 0, -low.x}, {-1, 0, high.x}, {0, 1, -low.y}, {0, -1, high.y}}};
    std::transform(edges.begin(), edges.end(), canvasEdges_.begin(),
                   [&](glm::dvec3 edge) { return glm::vec3(clipFromEdge * edge); });
}

std::vector<gpu::InstancedMeshes::Mesh> PlacedSource::meshes(double longestEdge) const {
    const pattern::ShapePattern& pattern = *source_.pattern;
    std::vector<double> largest(pattern.shapes.size(), 0);
    for (const pattern::ShapeInstance& instance : pattern.instances)
        largest[instance.shape] = std::max(largest[instance.shape], instance.size);
    std::vector<gpu::InstancedMeshes::Mesh> meshes;
    for (std::size_t shape = 0; shape < pattern.shapes.size(); ++shape) {
        meshes.push_back({facetMesh(cutUp(pattern.shapes[shape].mesh, longestEdge / largest[shape])), 0});
    }
    for (const pattern::ShapeInstance& instance : pattern.instances) ++meshes[instance.shape].instances;
    return meshes;
}

bool PlacedSource::mirrored() const {
    // Canvas and projector have y down, OpenGL has y up. So the warp of an upright picture flips,
    // and so does canvasFromShape.
    return glm::determinant(clipFromCanvas_) > 0;
}

void PlacedSource::place(Time time, const Wind& wind, const show::PatternExchange& exchange, std::span<gpu::Instance> out) {
    FANTASCOPE_CHECK(out.size() == order_.size(), "there is one place per instance");
    if (source_.motion) source_.motion->posesAt(time, wind, poses_);
    if (source_.rests) source_.rests->mix(exchange, poses_);

    // Each instance has its own slice of the depths 0 .. 1, the last instance the nearest. Clip z
    // is that depth times the warp's w, so the map from space to clip space is projective, and
    // depth order is kept at every point of the canvas.
    const double slice = 1.0 / static_cast<double>(order_.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
        const std::size_t rank = order_[i];
        const pattern::InstancePose& pose = poses_[rank];
        const glm::dmat3 canvasFromShape = pattern::canvasFromShape({pose.centre, 1, pose.rotation});  // without size and centre
        const double depth = 1 - (static_cast<double>(rank) + 0.5) * slice;
        const auto clip = [&](glm::dvec3 canvas, double depth) {
            const glm::dvec3 warped = clipFromCanvas_ * canvas;
            return glm::vec4(warped.x, warped.y, depth, warped.z);
        };
        gpu::Instance& instance = out[i];
        for (int axis = 0; axis < 3; ++axis) {
            const glm::dvec3 along = canvasFromShape[axis];
            instance.clipFromShape[axis] = clip(glm::dvec3(pose.size * glm::dvec2(along), 0), -0.5 * slice * along.z);
        }
        instance.clipFromShape[3] = clip(glm::dvec3(pose.centre, 1), depth);
        instance.towardsLight = glm::transpose(canvasFromShape) * kTowardsLight;
        instance.colour = source_.pattern->instances[rank].colour;
    }
}

}  // namespace fantascope::render
