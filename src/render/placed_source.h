#pragma once

#include "render/canvas/canvas_warp.h"
#include "render/gpu/instanced_meshes.h"
#include "render/source/picture_source.h"

#include "core/clock.h"
#include "core/wind.h"

#include <glm/mat3x3.hpp>

#include <array>
#include <cmath>
#include <span>
#include <vector>

namespace fantascope::render {

// One light pattern as it stands in one output's picture: which meshes, and at any time where their
// instances are, through the warp. Instances are opaque to each other: of two, the later one in the
// pattern's order lies on top, whole. Thread: thread-bound.
class PlacedSource {
public:
    PlacedSource(const PatternSource& source, const CanvasPlace& place);

    // Stands elsewhere from now on.
    void follow(const CanvasPlace& place);
    // The meshes with the number of their instances, in the order in which place() fills them.
    // `longestEdge`: canvas heights that no triangle's edge exceeds; larger triangles are cut up.
    std::vector<gpu::InstancedMeshes::Mesh> meshes(double longestEdge = INFINITY) const;
    // Whether the warp turns the canvas over, as for rear projection.
    bool mirrored() const;
    // The edges of the canvas's shown part: a clip space point (x, y, z, w) is inside when its (x,
    // y, w) has no negative dot product with any, before a mesh bends it.
    const std::array<glm::vec3, 4>& canvasEdges() const { return canvasEdges_; }
    // All instances at show time `time`, in the wind of then. No allocation.
    void place(Time time, const Wind& wind, std::span<gpu::Instance> out);

private:
    PatternSource source_;
    glm::dmat3 clipFromCanvas_{1};  // (x, y, w) = clipFromCanvas_ * (canvas x, canvas y, 1), w >= 1 all over the shown part
    std::array<glm::vec3, 4> canvasEdges_{};
    std::vector<pattern::InstancePose> poses_;  // in the pattern's order; at rest where nothing moves
    std::vector<std::size_t> order_;            // the pattern's instances, mesh by mesh
};

}  // namespace fantascope::render
