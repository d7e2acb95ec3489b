#pragma once

#include "render/canvas/canvas_warp.h"
#include "render/gpu/bend.h"
#include "render/gpu/handles.h"
#include "render/gpu/program_cache.h"

#include "core/result.h"

#include <glm/mat3x3.hpp>
#include <glm/vec4.hpp>

#include <string>

namespace fantascope::render::gpu {

// The geometry of a canvas's shown part, through the output's warp: one rectangle, or many small
// ones if a mesh bends it. The fragment shader gets `onCanvas`, 0 .. 1 in both directions. Thread:
// the context's.
class CanvasSurface {
public:
    // `bend`: the mesh of the same output. `programs` and `bend` outlive it. Error: the fragment
    // shader does not compile.
    static Result<CanvasSurface> create(const std::string& fragmentShader, const std::string& definitions, const Bend& bend,
                                        ProgramCache& programs);

    // Sets where the output shows the canvas; called before the first draw() and after every
    // change.
    void follow(const CanvasPlace& place);
    // Makes the fragment shader's program current, so that its uniforms can be set before draw().
    void use();
    void draw();

private:
    CanvasSurface(unsigned straight, unsigned bent, const Bend& bend) : straight_(straight), bent_(bent), bend_(&bend) {}

    unsigned straight_, bent_;
    const Bend* bend_;
    glm::mat3 clipFromCanvas_{1};
    glm::vec4 part_{0, 0, 1, 1};  // of the canvas: left, top, width, height
    VertexArray noVertices_;
};

}  // namespace fantascope::render::gpu
