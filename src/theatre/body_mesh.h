#pragma once

#include "theatre/posed_body.h"

#include "core/mesh.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace fantascope::theatre {

// The skin of a body: a closed mesh that follows the joints by linear blend skinning (Theta of Won & Lee 2016, section 3).
struct BodyMesh {
    static constexpr std::size_t kInfluences = 4;

    TriangleMesh atRest;                                         // metres, in the stage's frame, of the body's rest pose
    std::vector<std::array<std::uint16_t, kInfluences>> joints;  // of each vertex; those with no share are 0
    std::vector<std::array<float, kInfluences>> shares;          // of each, adding up to 1, the largest first

    // Where the vertices are in a pose of the body, metres, stage frame.
    void skin(const Body& body, const PosedBody& posed, std::vector<glm::vec3>& vertices) const;
};

// The skin of humanBody(): some 5,000 triangles, watertight, made for the stature.
BodyMesh humanMesh(const Body& body);

}  // namespace fantascope::theatre
