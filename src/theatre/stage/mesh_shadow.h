#pragma once

#include "theatre/body/body_mesh.h"
#include "theatre/mask/bit_mask.h"
#include "theatre/stage/stage.h"

namespace fantascope::theatre {

// The shadow of a closed mesh: the pixels whose centres lie in the shadow of any of its triangles.
// A ray from the light enters a closed mesh as often as it leaves it. So a pixel is in shadow if
// the winding number of the outline around it is not 0. The outline consists of the edges between a
// triangle that faces the light and one that does not. Memory is reused from mesh to mesh. Thread:
// thread-bound.
class MeshShadow {
public:
    // Adds the shadow to a mask of the frame's size. `vertices`: those of the mesh in a pose,
    // metres, stage frame. A mesh that reaches as far from the screen as the light has no bounded
    // shadow: it adds nothing, and the result is false.
    bool add(const ScreenFrame& frame, const BodyMesh& mesh, std::span<const glm::vec3> vertices, BitMask& mask);

private:
    void findOutline(const BodyMesh& mesh);
    void cross(glm::vec2 a, glm::vec2 b, int turn, const BitMask& mask);

    std::vector<float> x_, y_;            // the vertices' shadows, pixels
    std::vector<std::uint8_t> faces_;     // of each triangle, whether it faces the light
    std::vector<std::uint32_t> outline_;  // edges between a triangle that faces the light and one that does not
    // The change of the winding number from a pixel's left neighbour to the pixel. A word holds
    // eight pixels of a row, as digits to the base 256 that may be negative. All are 0 between
    // calls.
    std::vector<std::uint64_t> turns_;
    std::size_t stride_ = 0;  // words a row
};

}  // namespace fantascope::theatre
