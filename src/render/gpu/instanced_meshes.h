#pragma once

#include "render/canvas/facet_mesh.h"
#include "render/gpu/handles.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace fantascope::render::gpu {

// One instance as assets/shaders/shape.vert reads it.
struct Instance {
    glm::mat4 clipFromShape{1};
    glm::vec3 towardsLight{0};  // unit, in the shape's frame
    glm::vec3 colour{0};        // linear light
};

// Meshes, each with a fixed number of instances whose places change every frame. Thread: the
// context's.
class InstancedMeshes {
public:
    struct Mesh {
        FacetMesh mesh;
        std::size_t instances = 0;
    };
    // `mirrored`: clipFromShape mirrors, as for rear projection.
    InstancedMeshes(std::span<const Mesh> meshes, bool mirrored);

    void setMirrored(bool mirrored) { mirrored_ = mirrored; }
    // The instances of the next draw(), mesh by mesh; the caller writes all of them. May wait for
    // the draw() of three frames ago.
    std::span<Instance> place();
    // Draws all instances where they were placed last, with the current program and depth test.
    void draw();

private:
    // One mesh's range of the buffers.
    struct Part {
        unsigned indexCount, firstIndex;
        int firstVertex;
        unsigned instanceCount, firstInstance;
        bool closed;
    };
    // The GPU may still read earlier frames' instances while the next ones are written.
    static constexpr std::size_t kFramesInFlight = 3;

    std::vector<Part> parts_;
    bool mirrored_;
    std::size_t instanceCount_ = 0;
    VertexArray vertexArray_;
    Buffer vertices_, indices_, instances_;
    Instance* mapped_ = nullptr;  // all of instances_: kFramesInFlight times instanceCount_
    std::array<Fence, kFramesInFlight> drawn_;
    std::size_t frame_ = 0;  // which third of instances_ was placed last
};

}  // namespace fantascope::render::gpu
