#pragma once

#include "media/mesh.h"

#include <glm/vec3.hpp>

#include <array>
#include <vector>

namespace fantascope::theatre {

// The signed distance to a mesh, negative inside, on a precomputed grid with interpolation (Bridson
// 2015, Fluid Simulation for Computer Graphics, section 4.3: exact near the surface, the nearest
// triangles propagated from there). A node is inside if, along at least two of the three axes, an
// odd number of triangles lies before it, so that a small hole in the mesh does no harm. Metres,
// the mesh's frame. Thread: reentrant.
class MeshDistance {
public:
    // The grid reaches `around` beyond the mesh and has kCells cells along its longest side; `mesh`
    // has at least one triangle.
    MeshDistance(const TriangleMesh& mesh, double around);
    static constexpr int kCells = 64;

    // The distance; `outward` becomes the unit direction in which it grows. Outside the grid the
    // result is a lower bound of the true distance, but exceeds `around`.
    double at(const glm::dvec3& point, glm::dvec3& outward) const;

private:
    std::size_t index(int x, int y, int z) const {
        return (static_cast<std::size_t>(z) * static_cast<std::size_t>(nodes_[1]) + static_cast<std::size_t>(y)) *
                   static_cast<std::size_t>(nodes_[0]) +
               static_cast<std::size_t>(x);
    }
    void measure(const TriangleMesh& mesh);
    void sign(const TriangleMesh& mesh);

    glm::dvec3 least_{0};  // the first node
    double cell_ = 0, around_ = 0;
    std::array<int, 3> nodes_{};
    std::vector<float> values_;  // x fastest
};

}  // namespace fantascope::theatre
