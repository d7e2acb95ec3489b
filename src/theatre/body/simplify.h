#pragma once

#include "media/mesh.h"

#include <functional>

namespace fantascope::theatre {

// Takes vertices from a closed mesh until it has no more than `triangles`, those first whose loss
// changes the form least: edges are collapsed in the order of their quadric error (Garland &
// Heckbert 1997), none that would join what is not neighbours (Dey et al. 1999) or turn a triangle
// over. `importance`: how much the form matters at a place. The mesh stays closed and of its genus;
// it may keep more triangles where nothing more can go.
TriangleMesh simplified(const TriangleMesh& mesh, std::size_t triangles,
                        const std::function<double(const glm::vec3&)>& importance);

// Takes vertices from a closed mesh wherever the form changes by no more than about `tolerance` by
// it, in the mesh's unit: edges as they come, those that cost least in the first of a few rounds.
// `mayGo`: whether a vertex may be touched. Much faster for a mesh of millions.
TriangleMesh simplifiedWithin(const TriangleMesh& mesh, double tolerance, const std::function<bool(const glm::vec3&)>& mayGo);

}  // namespace fantascope::theatre
