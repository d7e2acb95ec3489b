#pragma once

#include "theatre/deform/triangulated_silhouette.h"

#include <Eigen/SparseCore>
#include <glm/vec2.hpp>

#include <memory>
#include <span>
#include <vector>

namespace fantascope::theatre {

// The error of the scale-free construction as a quadratic form v' G v of the coordinates v = (x0,
// y0, x1, y1, ..): for each corner of each triangle the square of its distance from where it would
// be if the triangle were only moved, turned and scaled to its other two (Igarashi et al. 2005,
// equations 1 to 5).
Eigen::SparseMatrix<double> scaleFreeError(const FlatMesh& rest);

// As-rigid-as-possible shape manipulation: a shape follows its handles, and its triangles are
// turned and moved as rigidly as they can be (Igarashi, Moscovich & Hughes, SIGGRAPH 2005). All
// matrices are factored once for a set of handles; a frame is a back-substitution for each step.
// Handles may be anywhere in the triangles. An island with one handle moves with it as a whole, one
// without stays. Where so many handles are in so few triangles that these cannot follow all, they
// follow as well as can be (least squares).
// Thread: reentrant once built.
class ShapeManipulation {
public:
    // The paper's registration and compilation.
    ShapeManipulation(const FlatMesh& rest, std::span<const CarriedPoint> handles);
    ~ShapeManipulation();
    ShapeManipulation(ShapeManipulation&&) noexcept;

    // The vertices once the handles are at their `places`, in the order given to the constructor:
    // both steps.
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
