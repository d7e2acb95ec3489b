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

// Skinned meshes whose shadows are drawn straight through a screen and an output's warp. Thread:
// the context's.
class ShadowCaster {
public:
    static constexpr std::size_t kMaxJoints = 64;

    // A vertex as assets/shaders/skin.comp reads it.
    struct Vertex {
        glm::vec3 atRest{0};                 // metres
        std::array<std::uint8_t, 4> joints;  // indices of its piece's joints
        std::array<float, 4> shares;         // weights of the joints; their sum is 1
    };
    struct Piece {
        std::vector<Vertex> vertices;
        std::vector<glm::uvec3> triangles;
        bool closed = false;  // triangles are anticlockwise from outside: back faces need not be drawn
    };
    // One point of light and the screen in front of it.
    struct Light {
        // To (X, Y, W): the shadow falls at X / W, Y / W on the screen; W is the distance from the
        // light along its axis, metres.
        glm::mat4x3 screenFromStage{1};
        glm::mat3 clipFromScreen{1};  // to (x, y, w), w >= 1 where W is 1; from the unrolled screen if it is curved
        glm::vec4 curve{0};           // of a curved screen: the light's place in its frame, and the cylinder's radius; metres
    };

    // `curved`: whether the screen is. `bend` and `programs` outlive it. Error: a shader does not
    // compile.
    static Result<ShadowCaster> create(std::span<const Piece> pieces, bool curved, const Bend& bend, ProgramCache& programs);

    // Sets how each joint of a piece has moved from rest: two vectors per joint, the w, x, y, z of
    // a unit dual quaternion's two parts. Called before the first drawing and after every movement.
    void move(std::size_t piece, std::span<const glm::vec4> motions);
    // Called after the last move() of a frame.
    void moved();

    // Paints a light's shadow into the current layer picture; where pieces overlap, the one nearest
    // to the light shows. `colours`: per piece, as the picture holds them. `inside`: four half
    // planes that clip it; a point with clip coordinates (x, y, z, w) is inside if dot(inside[i],
    // (x, y, w)) >= 0 for each i.
    void paint(const Light& light, std::span<const glm::vec3> colours, const std::array<glm::vec3, 4>& inside);
    // The same into the current render target, with the current tests and without clipping.
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
