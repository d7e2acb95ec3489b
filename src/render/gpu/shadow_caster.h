#pragma once

#include "render/gpu/bend.h"
#include "render/gpu/handles.h"
#include "render/gpu/program_cache.h"

#include "core/result.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace fantascope::render::gpu {

// Shadows of meshes that follow joints, straight through an output's warp: what they take away of lamps' light, in a picture of the output. A frame: move() every
// piece that moved; begin(); cast() once for each point of light; end(). Thread: the context's.
class ShadowCaster {
public:
    static constexpr std::size_t kMostJoints = 64;

    // A vertex as assets/shaders/skin.comp reads it.
    struct Vertex {
        glm::vec3 atRest{0};                 // metres
        std::array<std::uint8_t, 4> joints;  // of its piece
        std::array<float, 4> shares;         // of each, adding up to 1
    };
    struct Piece {
        std::vector<Vertex> vertices;
        std::vector<glm::uvec3> triangles;
        bool closed = false;  // anticlockwise as seen from outside: half of them need not be drawn
    };
    // One point of light.
    struct Light {
        glm::mat4x3 screenFromStage{
            1};  // (X, Y, W), the shadow being at X / W, Y / W on the screen; W is the distance from the light along its axis, metres
        glm::mat3 clipFromScreen{1};  // (x, y, w), w >= 1 where W is 1
    };

    // `size`: pixels of the output; `samples`: a pixel. `bend` and `programs` outlive it. Error: more of them than this OpenGL has; a shader that does
    // not compile.
    static Result<ShadowCaster> create(std::span<const Piece> pieces, glm::ivec2 size, int samples, const Bend& bend,
                                       ProgramCache& programs);

    // How each joint of a piece has moved from rest: two vectors each, the parts w, x, y, z of a unit dual quaternion.
    void move(std::size_t piece, std::span<const glm::vec4> motions);
    // Makes the picture the target of drawing; nothing is in shadow.
    void begin();
    // What each piece takes away in its shadow, linear light. Where shadows of pieces meet, that of the piece nearest to the light counts; `alike`: all
    // pieces take the same, so that it need not be found out which that is.
    void cast(const Light& light, std::span<const glm::vec3> taken, bool alike);
    void end();

    int samples() const { return samples_; }
    unsigned texture() const { return taken_.name(); }  // several samples a pixel

private:
    struct Part {
        unsigned firstVertex, vertexCount, firstIndex, indexCount;
        bool closed;
    };

    ShadowCaster(glm::ivec2 size, const Bend& bend) : size_(size), bend_(&bend) {}
    void draw(std::span<const glm::vec3> taken);

    glm::ivec2 size_;
    int samples_ = 0;
    const Bend* bend_;
    unsigned skin_ = 0, straight_ = 0, bent_ = 0;
    std::vector<Part> parts_;
    VertexArray vertexArray_;
    Buffer atRest_, moved_, indices_;
    MultisampleTexture taken_;
    Renderbuffer depth_;
    Framebuffer framebuffer_;
    int mark_ = 0;  // of the samples that this light has reached already
};

}  // namespace fantascope::render::gpu
