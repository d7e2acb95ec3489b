#pragma once

#include "core/mesh.h"

#include <array>
#include <functional>
#include <vector>

namespace fantascope::theatre {

// The planes of a grid along x, y and z, ascending; they may stand closer where a form is finer.
using GridPlanes = std::array<std::vector<double>, 3>;

// The surface where a field is 0, its inside where the field is negative: closed, each edge between two triangles, as long as the
// field is positive on the grid's outermost planes. Marching tetrahedra: six to a cell, all around the same diagonal, so that
// cells agree on the faces between them. `field` tells how far the surface is, up to a factor of `slack`: farther off it is not
// looked at closely.
TriangleMesh implicitSurface(const std::function<double(const glm::dvec3&)>& field, const GridPlanes& planes, double slack);

}  // namespace fantascope::theatre
