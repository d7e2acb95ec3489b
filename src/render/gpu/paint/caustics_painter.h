#pragma once

#include "render/gpu/handles.h"
#include "render/gpu/program_cache.h"

#include "core/result.h"

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <span>

namespace fantascope::render::gpu {

// Paints the light under waves into the current LightCanvas. Thread: the context's.
class CausticsPainter {
public:
    // `margin`: by how much the grid of rays extends beyond the canvas; `step`: its maximum
    // spacing; both in canvas heights. `waves`: how many paint() gets. `programs` outlives it.
    // Error: a shader does not compile.
    static Result<CausticsPainter> create(double aspect, double margin, double step, int waves, ProgramCache& programs);

    // `waves`: from Water::at().
    void paint(std::span<const glm::vec4> waves);

private:
    CausticsPainter(unsigned program, float aspect) : program_(program), aspect_(aspect) {}

    unsigned program_;
    float aspect_;
    glm::ivec2 points_{0};
    glm::vec4 grid_{0};
    int indexCount_ = 0;
    VertexArray noVertices_;
    Buffer indices_;
};

}  // namespace fantascope::render::gpu
