#pragma once

#include "theatre/body/body_part.h"
#include "theatre/body/mesh_distance.h"

#include <glm/gtc/quaternion.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace fantascope::theatre {

// A rigid thing on the stage, scenery or something that an actor holds: E_k of Won & Lee 2016,
// equation 6. Its shadow is nobody's.
struct Prop {
    // In the prop's frame, metres.
    struct Shape {
        explicit Shape(TriangleMesh given) : mesh(std::move(given)), distance(mesh, kAround) {}
        static constexpr double kAround = 0.2;  // no body's capsule is thicker
        TriangleMesh mesh;
        MeshDistance distance;
    };
    struct Holder {
        std::size_t actor = 0;  // from 0
        BodyPart part{};
    };

    std::string name;
    std::filesystem::path file{};  // that its mesh was read from
    std::shared_ptr<const Shape> shape;
    std::optional<Holder> holder;  // none: it stands
    // Of the prop's frame: of one that stands in the stage's. Of one that is held, from the part's
    // point, in the axes of the T-pose: +x the holder's left, +y up, +z before him.
    glm::dvec3 place{0};
    glm::dquat turn{1, 0, 0, 0};
};

}  // namespace fantascope::theatre
