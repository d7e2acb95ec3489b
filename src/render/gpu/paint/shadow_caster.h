#pragma once

#include "render/gpu/bend.h"
#include "render/gpu/handles.h"
#include "render/gpu/program_cache.h"

#include "core/result.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace fantascope::render::gpu {

// Meshes that follow joints, and their shadows, straight through a screen and an output's warp.
// Thread: the context's.
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
    // One point of light, and the screen before it.
    struct Light {
        glm::mat4x3 screenFromStage{
            1};  // (X, Y, W), the shadow being at X / W, Y / W on the screen; W: metres from the light, along its axis
        glm::mat3 clipFromScreen{1};  // (x, y, w), w >= 1 where W is 1; of a curved screen unrolled
        glm::vec4 curve{0};           // of a curved screen: where the light is in its frame, and the cylinder's radius; metres
    };

    // `curved`: the screen is. `bend` and `programs` outlive it. Error: a shader does not compile.
    static Result<ShadowCaster> create(std::span<const Piece> pieces, bool curved, const Bend& bend, ProgramCache& programs);

    // How each joint of a piece has moved from rest: two vectors each, the parts w, x, y, z of a
    // unit dual quaternion. Before the first drawing, and whenever it has moved.
    void move(std::size_t piece, std::span<const glm::vec4> motions);
    // After the last move() of a frame.
    void moved();

    // Paints a light's shadow into the picture that has begun: of pieces that are behind each other
    // the one nearest to the light. `colours`: of each piece, as the picture holds them. `inside`:
    // four half planes that bound where it is seen; a point with clip coordinates (x, y, z, w) is
    // in when dot(inside[i], (x, y, w)) >= 0 for each.
    void paint(const Light& light, std::span<const glm::vec3> colours, const std::array<glm::vec3, 4>& inside);
    // The same into the target that is set, by the tests that are set, wherever it falls.
    void draw(const Light& light, std::span<const glm::vec3> colours);

private:
    struct Part {
        unsigned firstVertex, vertexCount, firstIndex, indexCount;
        bool closed;
    };
    struct Programs {
        unsigned straight, bent;
    };

    ShadowCaster(bool curved, const Bend& bend) : curved_(curved), bend_(&bend) {}
    void draw(const Programs& programs, const Light& light, std::span<const glm::vec3> colours,
              const std::array<glm::vec3, 4>* inside);

    bool curved_;
    const Bend* bend_;
    unsigned skin_ = 0;
    Programs anywhere_{}, inside_{};
    std::vector<Part> parts_;
    VertexArray vertexArray_;
    Buffer atRest_, moved_, indices_;
};

}  // namespace fantascope::render::gpu
