#pragma once

#include "media/mesh.h"

#include <functional>

namespace fantascope::theatre {

// Simplifies a closed mesh to no more than `triangles`. Edges are collapsed in the order of their
// quadric error (Garland & Heckbert 1997), except those whose collapse would change the topology
// (Dey et al. 1999) or turn a triangle over. `importance` weighs the error at a place. The mesh
// stays closed and keeps its genus. It keeps more triangles if no edge can be collapsed any more.
TriangleMesh simplified(const TriangleMesh& mesh, std::size_t triangles,
                        const std::function<double(const glm::vec3&)>& importance);

// Simplifies a closed mesh wherever the surface changes by no more than about `tolerance`, in the
// mesh's unit. Edges are collapsed in their order in the mesh, in a few rounds; the first rounds
// take only the cheapest. `mayGo`: whether a vertex may be removed or moved. It is much faster for
// a mesh of millions of triangles.
TriangleMesh simplifiedWithin(const TriangleMesh& mesh, double tolerance, const std::function<bool(const glm::vec3&)>& mayGo);

}  // namespace fantascope::theatre
