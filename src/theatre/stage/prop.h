#pragma once

#include "theatre/body/body_part.h"
#include "theatre/body/mesh_distance.h"

#include <glm/gtc/quaternion.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace fantascope::theatre {

// A rigid object on the stage, either scenery or held by an actor: E_k of Won & Lee 2016, equation
// 6. Its shadow belongs to no actor.
struct Prop {
    // In the prop's frame, metres.
    struct Shape {
        explicit Shape(TriangleMesh given) : mesh(std::move(given)), distance(mesh, kAround) {}
        static constexpr double kAround = 0.2;  // metres around the mesh; no capsule of a body is thicker
        TriangleMesh mesh;
        MeshDistance distance;
    };
    struct Holder {
        std::size_t actor = 0;  // from 0
        BodyPart part{};
    };

    std::string name;
    std::filesystem::path file{};  // of its mesh
    std::shared_ptr<const Shape> shape;
    std::optional<Holder> holder;  // none: the prop stands
    // Position and rotation of the prop's frame. A standing prop's are in the stage's frame. A held
    // prop's are relative to the part's point, in the axes of the T-pose: +x to the holder's left,
    // +y up, +z to his front.
    glm::dvec3 place{0};
    glm::dquat turn{1, 0, 0, 0};
};

}  // namespace fantascope::theatre
