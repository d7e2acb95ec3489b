#pragma once

#include "theatre/deform/triangulated_silhouette.h"

#include <Eigen/SparseCore>
#include <glm/vec2.hpp>

#include <memory>
#include <span>
#include <vector>

namespace fantascope::theatre {

// The error of the scale-free construction as a quadratic form v' G v of the coordinates v = (x0,
// y0, x1, y1, ..): for each corner of each triangle, the squared distance from its place in the
// triangle at rest, moved, rotated and scaled to fit the other two corners (Igarashi et al. 2005,
// equations 1 to 5).
Eigen::SparseMatrix<double> scaleFreeError(const FlatMesh& rest);

// As-rigid-as-possible shape manipulation: a shape follows its handles, and its triangles move as
// rigidly as possible (Igarashi, Moscovich & Hughes, SIGGRAPH 2005). All matrices are factored once
// for a set of handles. A frame takes one back-substitution for each of the two steps. Handles may
// be anywhere in the triangles. An island with one handle is translated with it; an island without
// a handle stays. If there are more handles than the triangles can follow, they follow in the
// least-squares sense.
// Thread: reentrant once built.
class ShapeManipulation {
public:
    // The paper's steps "registration" and "compilation".
    ShapeManipulation(const FlatMesh& rest, std::span<const CarriedPoint> handles);
    ~ShapeManipulation();
    ShapeManipulation(ShapeManipulation&&) noexcept;

    // The vertices after both steps, with the handles at `places`, in the order given to the
    // constructor.
    std::vector<glm::dvec2> deformed(std::span<const glm::dvec2> places) const;
    // The result of step one alone (section 4.1), in which triangles are scaled as well.
    std::vector<glm::dvec2> scaleFree(std::span<const glm::dvec2> places) const;

private:
    class Island;
    std::vector<glm::dvec2> apply(std::span<const glm::dvec2> places, bool isScaleAdjusted) const;

    std::vector<glm::dvec2> rest_;
    std::vector<std::unique_ptr<Island>> islands_;  // those with a handle
};

}  // namespace fantascope::theatre
