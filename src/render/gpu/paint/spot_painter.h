#pragma once

#include "render/gpu/handles.h"
#include "render/gpu/program_cache.h"

#include "core/result.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <span>

namespace fantascope::render::gpu {

// Paints a mirror ball's spots of light into the current LightCanvas. Thread: the context's.
class SpotPainter {
public:
    // One mirror of the ball, at rest; unit vectors.
    struct Facet {
        glm::vec3 outwards{0};  // direction of its middle from the ball's centre
        glm::vec3 normal{0};
    };
    // In metres from the canvas's middle: right, up, out of the wall.
    struct Scene {
        glm::vec3 ball{0}, lamp{0};
        float ballRadius, halfFacet, lampRadius;
        glm::vec2 canvas{0};  // its size
    };
    // `programs` outlives it. Error: a shader does not compile.
    static Result<SpotPainter> create(std::span<const Facet> facets, const Scene& scene, ProgramCache& programs);

    // Paints the spots of the ball turned by `angle` radians, anticlockwise as seen from above.
    void paint(float angle);

private:
    SpotPainter(unsigned program, const Scene& scene, int indexCount)
        : program_(program), scene_(scene), indexCount_(indexCount) {}

    unsigned program_;
    Scene scene_;
    int indexCount_;
    VertexArray vertexArray_;
    Buffer corners_, indices_;
};

}  // namespace fantascope::render::gpu
