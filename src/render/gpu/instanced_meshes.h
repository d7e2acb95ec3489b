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

// Meshes with a fixed number of instances each, whose places change every frame. Thread: the
// context's.
class InstancedMeshes {
public:
    struct Mesh {
        FacetMesh mesh;
        std::size_t instances = 0;
    };
    // `mirrored`: clipFromShape turns the shapes inside out, as a picture for rear projection does.
    InstancedMeshes(std::span<const Mesh> meshes, bool mirrored);

    void setMirrored(bool mirrored) { mirrored_ = mirrored; }
    // The instances of the next draw(), those of the first mesh first; to be written whole. May
    // wait for the drawing of three frames ago.
    std::span<Instance> place();
    // Draws all instances as they were placed last, with the program and the depth test that are
    // set.
    void draw();

private:
    // One mesh's share of the buffers.
    struct Part {
        unsigned indexCount, firstIndex;
        int firstVertex;
        unsigned instanceCount, firstInstance;
        bool closed;
    };
    // The GPU may still read the instances of the frames before while the next are written.
    static constexpr std::size_t kFramesInFlight = 3;

    std::vector<Part> parts_;
    bool mirrored_;
    std::size_t instanceCount_ = 0;
    VertexArray vertexArray_;
    Buffer vertices_, indices_, instances_;
    Instance* mapped_ = nullptr;  // all of instances_: kFramesInFlight times instanceCount_
    std::array<Fence, kFramesInFlight> drawn_;
    std::size_t frame_ = 0;  // the third of instances_ that was placed last
};

}  // namespace fantascope::render::gpu
