#pragma once

#include "theatre/body/posed_body.h"

#include "media/mesh.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace fantascope::theatre {

// An edge of a closed mesh: two vertices, and the triangles on its left and right. It runs
// anticlockwise around the left one.
struct MeshEdge {
    std::uint32_t from = 0, to = 0, left = 0, right = 0;
};
// All edges of a mesh, in the order of their first triangle. Empty if the mesh is not closed, that
// is, if an edge does not have exactly one triangle on each side.
std::vector<MeshEdge> edgesOf(const TriangleMesh& mesh);

// A rigid motion from the rest pose as a unit dual quaternion: the rotation's w, x, y, z, then the
// dual part's.
using DualQuaternion = std::array<float, 8>;
DualQuaternion motionOf(const glm::dquat& turn, const glm::dvec3& shift);  // first turned, then shifted
// The motion of each joint from the rest pose, ready for blending: adjacent joints are on one side
// of the double cover. `motions` has one element for each joint.
void jointMotions(const Body& body, const PosedBody& posed, std::span<DualQuaternion> motions);

// The skin of a body: a closed mesh that follows the joints (Theta of Won & Lee 2016, section 3) by
// dual quaternion blending (Kavan et al. 2008). Linear blending would flatten a knee bent by 140
// degrees to a third of its girth.
struct BodyMesh {
    static constexpr std::size_t kInfluences = 4, kMostJoints = 64;

    TriangleMesh atRest;                                         // metres, in the stage's frame, of the body's rest pose
    std::vector<MeshEdge> edges;                                 // edgesOf(atRest)
    std::vector<std::array<std::uint16_t, kInfluences>> joints;  // of each vertex; 0 where the share is 0
    std::vector<std::array<float, kInfluences>> shares;          // of each vertex; they add up to 1, the largest first
    // The same skin with fewer triangles, for a search that evaluates it many thousand times. If
    // null, this one serves.
    std::shared_ptr<const BodyMesh> simpler{};

    // Where the vertices are in a pose of the body, metres, stage frame.
    void skin(const Body& body, const PosedBody& posed, std::vector<glm::vec3>& vertices) const;
};

// The skin of humanBody(), made for its stature: watertight, about 5,000 triangles, and 1,500 in
// the simpler one.
BodyMesh humanMesh(const Body& body);

}  // namespace fantascope::theatre
