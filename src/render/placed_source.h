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

// One light pattern in one output's picture: its meshes, and at any time the places of their
// instances through the warp. Instances hide each other: of two, the later in the pattern's order
// lies entirely on top. Thread: thread-bound.
class PlacedSource {
public:
    PlacedSource(const PatternSource& source, const CanvasPlace& place);

    // Sets a new place.
    void follow(const CanvasPlace& place);
    // The meshes with the numbers of their instances, in the order in which place() fills them.
    // `longestEdge`: maximum length of a triangle's edge, canvas heights; larger triangles are cut
    // up.
    std::vector<gpu::InstancedMeshes::Mesh> meshes(double longestEdge = INFINITY) const;
    // Whether the warp mirrors the canvas, as for rear projection.
    bool mirrored() const;
    // The edges of the canvas's shown part. A point in clip space (x, y, z, w) is inside if (x, y,
    // w) has no negative dot product with any of them, before a mesh bends it.
    const std::array<glm::vec3, 4>& canvasEdges() const { return canvasEdges_; }
    // Fills `out` with all instances at show time `time`, in the wind of that time. `exchange`: the
    // shares of the patterns, if the source is one of an exchange. Does not allocate.
    void place(Time time, const Wind& wind, const show::PatternExchange& exchange, std::span<gpu::Instance> out);

private:
    PatternSource source_;
    glm::dmat3 clipFromCanvas_{1};  // (x, y, w) = clipFromCanvas_ * (canvas x, canvas y, 1), w >= 1 on the whole shown part
    std::array<glm::vec3, 4> canvasEdges_{};
    std::vector<pattern::InstancePose> poses_;  // in the pattern's order; at rest if nothing moves
    std::vector<std::size_t> order_;            // indices of the pattern's instances, mesh by mesh
};

}  // namespace fantascope::render
