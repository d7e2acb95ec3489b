#pragma once

#include "theatre/body/body_mesh.h"
#include "theatre/mask/bit_mask.h"
#include "theatre/stage/stage.h"

namespace fantascope::theatre {

// The shadow of a closed mesh: the pixels whose centres lie in the shadow of any of its triangles.
// Seen from the light every ray enters a closed mesh as often as it leaves it, so that a pixel's
// shadow is told by how often the outlines of what faces the light, the edges between a triangle
// that does and one that does not, wind around it. Thread: thread-bound; it keeps its memory from
// mesh to mesh.
class MeshShadow {
public:
    // Adds the shadow to a mask of the frame's size. `vertices`: those of the mesh in a pose,
    // metres, stage frame. A mesh that reaches the light's height above the screen, where it would
    // throw no bounded shadow, adds nothing and gives false.
    bool add(const ScreenFrame& frame, const BodyMesh& mesh, std::span<const glm::vec3> vertices, BitMask& mask);

private:
    void findOutline(const BodyMesh& mesh);
    void cross(glm::vec2 a, glm::vec2 b, int turn, const BitMask& mask);

    std::vector<float> x_, y_;            // the vertices' shadows, pixels
    std::vector<std::uint8_t> faces_;     // of each triangle, whether it faces the light
    std::vector<std::uint32_t> outline_;  // edges between a triangle that does and one that does not
    // How much more often the outlines wind around a pixel than around its left neighbour: eight
    // pixels of a row in a word, as digits to the base of 256 that may be negative. All 0 from mesh
    // to mesh.
    std::vector<std::uint64_t> turns_;
    std::size_t stride_ = 0;  // words a row
};

}  // namespace fantascope::theatre
