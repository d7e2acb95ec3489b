#include "theatre/deform/shape_manipulation.h"

#include "core/check.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <array>
#include <complex>
#include <cstdint>
#include <optional>
#include <utility>

namespace fantascope::theatre {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Triplets = std::vector<Eigen::Triplet<double>>;
using Complex = std::complex<double>;  // a point of the plane: a product turns and scales

Complex complexOf(glm::dvec2 point) { return {point.x, point.y}; }

Sparse matrixOf(Eigen::Index rows, Eigen::Index columns, const Triplets& entries) {
    Sparse matrix(rows, columns);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
}

// Section 4.2: the squared difference of each triangle's edges from those of the fitted triangle,
// as a quadratic form. It is the same for x and y.
Sparse edgeError(const FlatMesh& rest) {
    Triplets entries;
    for (const glm::uvec3& triangle : rest.triangles)
        for (int corner = 0; corner < 3; ++corner) {
            const auto i = static_cast<int>(triangle[corner]), j = static_cast<int>(triangle[(corner + 1) % 3]);
            entries.insert(entries.end(), {{i, i, 1}, {j, j, 1}, {i, j, -1}, {j, i, -1}});
        }
    const auto size = static_cast<Eigen::Index>(rest.vertices.size());
    return matrixOf(size, size, entries);
}

// Minimises v' G v - 2 b' v subject to C v = q. G is singular, but the constraints fix its null
// space, so G + C'C is positive definite. The added term (C v - q)^2 is zero at the solution and
// changes nothing.
class ConstrainedQuadratic {
public:
    ConstrainedQuadratic(const Sparse& form, const Sparse& constraints) : constraints_(constraints) {
        matrix_ = form + Sparse(constraints.transpose()) * constraints;
        factored_.compute(matrix_);
        FANTASCOPE_CHECK(factored_.info() == Eigen::Success, "the handles hold the island");
        response_ = solved(Eigen::MatrixXd(constraints.transpose()));
        multipliers_.setThreshold(kRedundant);
        multipliers_.compute(constraints * response_);
    }

    // Each column of b and q is a problem of its own.
    Eigen::MatrixXd minimum(const Eigen::MatrixXd& b, const Eigen::MatrixXd& q) const {
        const Eigen::MatrixXd free = solved(b + constraints_.transpose() * q);
        return free + response_ * multipliers_.solve(q - constraints_ * free);
    }

private:
    // Below this threshold, constraints are redundant up to rounding.
    static constexpr double kRedundant = 1e-9;

    // One step of iterative refinement makes rigid movements accurate to the last digits.
    Eigen::MatrixXd solved(const Eigen::MatrixXd& right) const {
        const Eigen::MatrixXd first = factored_.solve(right);
        return first + factored_.solve(right - matrix_ * first);
    }

    Sparse matrix_, constraints_;
    Eigen::SimplicialLDLT<Sparse> factored_;
    Eigen::MatrixXd response_;                                             // to each constraint's multiplier
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> multipliers_;  // redundant constraints share them
};

}  // namespace

Sparse scaleFreeError(const FlatMesh& rest) {
    Triplets entries;
    for (const glm::uvec3& triangle : rest.triangles)
        for (int corner = 0; corner < 3; ++corner) {
            const std::array<std::uint32_t, 3> at = {triangle[corner], triangle[(corner + 1) % 3], triangle[(corner + 2) % 3]};
            // v2 = v0 + x01 (v1 - v0) + y01 R90 (v1 - v0), in complex numbers v0 + (x01 + i y01)
            // (v1 - v0).
            const std::array<Complex, 3> v = {complexOf(rest.vertices[at[0]]), complexOf(rest.vertices[at[1]]),
                                              complexOf(rest.vertices[at[2]])};
            const Complex local = (v[2] - v[0]) / (v[1] - v[0]);
            // The deviation of v2 from that place is the sum of these factors times the vertices.
            // Its squared modulus is a quadratic form with entries conj(a) b, as real 2 x 2 blocks.
            const std::array<Complex, 3> factors = {local - 1.0, -local, Complex(1)};
            for (std::size_t a = 0; a < 3; ++a)
                for (std::size_t b = 0; b < 3; ++b) {
                    const Complex block = std::conj(factors[a]) * factors[b];
                    const int row = 2 * static_cast<int>(at[a]), column = 2 * static_cast<int>(at[b]);
                    entries.insert(entries.end(), {{row, column, block.real()},
                                                   {row, column + 1, -block.imag()},
                                                   {row + 1, column, block.imag()},
                                                   {row + 1, column + 1, block.real()}});
                }
        }
    const auto size = static_cast<Eigen::Index>(2 * rest.vertices.size());
    return matrixOf(size, size, entries);
}

// One island with its handles. Its vertices are renumbered from 0 and relative to their mean, so
// that digits are not lost.
class ShapeManipulation::Island {
public:
    Island(FlatMesh rest, std::vector<std::size_t> vertices, std::vector<CarriedPoint> points, std::vector<std::size_t> handles)
        : rest_(std::move(rest)), vertices_(std::move(vertices)), handles_(std::move(handles)) {
        for (const glm::dvec2 vertex : rest_.vertices) middle_ += vertex / static_cast<double>(rest_.vertices.size());
        for (glm::dvec2& vertex : rest_.vertices) vertex -= middle_;
        Triplets once, twice;
        for (std::size_t row = 0; row < points.size(); ++row)
            for (int corner = 0; corner < 3; ++corner) {
                const auto i = static_cast<int>(row), j = static_cast<int>(rest_.triangles[points[row].triangle][corner]);
                const double share = points[row].shares[corner];
                once.emplace_back(i, j, share);
                for (int axis = 0; axis < 2; ++axis) twice.emplace_back(2 * i + axis, 2 * j + axis, share);
            }
        const auto rows = static_cast<Eigen::Index>(points.size()), columns = static_cast<Eigen::Index>(rest_.vertices.size());
        const Sparse constraints = matrixOf(rows, columns, once);
        Eigen::MatrixXd places(columns, 2);
        for (Eigen::Index i = 0; i < columns; ++i)
            places.row(i) << rest_.vertices[std::size_t(i)].x, rest_.vertices[std::size_t(i)].y;
        atRest_ = constraints * places;
        if (points.size() == 1) return;
        stepOne_.emplace(scaleFreeError(rest_), matrixOf(2 * rows, 2 * columns, twice));
        stepTwo_.emplace(edgeError(rest_), constraints);
    }

    void apply(std::span<const glm::dvec2> places, bool isScaleAdjusted, std::vector<glm::dvec2>& result) const {
        Eigen::MatrixXd q(static_cast<Eigen::Index>(handles_.size()), 2);
        for (std::size_t i = 0; i < handles_.size(); ++i) {
            const glm::dvec2 place = places[handles_[i]] - middle_;
            q.row(static_cast<Eigen::Index>(i)) << place.x, place.y;
        }
        std::vector<glm::dvec2> own = rest_.vertices;
        if (stepOne_) {
            own = scaleFree(q);
            if (isScaleAdjusted) own = scaleAdjusted(own, q);
        } else {
            for (glm::dvec2& vertex : own) vertex += glm::dvec2(q(0, 0) - atRest_(0, 0), q(0, 1) - atRest_(0, 1));
        }
        for (std::size_t i = 0; i < own.size(); ++i) result[vertices_[i]] = middle_ + own[i];
    }

private:
    std::vector<glm::dvec2> scaleFree(const Eigen::MatrixXd& q) const {
        const auto size = static_cast<Eigen::Index>(2 * rest_.vertices.size());
        const Eigen::MatrixXd stacked = q.transpose().reshaped();  // x0, y0, x1, ..
        const Eigen::MatrixXd v = stepOne_->minimum(Eigen::MatrixXd::Zero(size, 1), stacked);
        std::vector<glm::dvec2> result;
        for (Eigen::Index i = 0; i < size; i += 2) result.emplace_back(v(i), v(i + 1));
        return result;
    }

    // Each triangle at rest is rotated to fit the result of step one. Then all triangles are joined
    // by least squares.
    std::vector<glm::dvec2> scaleAdjusted(const std::vector<glm::dvec2>& intermediate, const Eigen::MatrixXd& q) const {
        Eigen::MatrixXd b = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rest_.vertices.size()), 2);
        for (const glm::uvec3& triangle : rest_.triangles) {
            const Complex turn = turnOf(triangle, intermediate);
            for (int corner = 0; corner < 3; ++corner) {
                const std::uint32_t i = triangle[corner], j = triangle[(corner + 1) % 3];
                const Complex edge = turn * complexOf(rest_.vertices[j] - rest_.vertices[i]);
                const Eigen::RowVector2d fitted(edge.real(), edge.imag());
                b.row(j) += fitted;
                b.row(i) -= fitted;
            }
        }
        const Eigen::MatrixXd v = stepTwo_->minimum(b, q);
        std::vector<glm::dvec2> result;
        for (Eigen::Index i = 0; i < v.rows(); ++i) result.emplace_back(v(i, 0), v(i, 1));
        return result;
    }

    // The rotation that fits best in the least-squares sense. It is that of the paper's similarity,
    // without the scale.
    Complex turnOf(const glm::uvec3& triangle, const std::vector<glm::dvec2>& intermediate) const {
        constexpr double kCollapsed = 1e-12;
        Complex sum = 0;
        double most = 0;
        for (int corner = 0; corner < 3; ++corner) {
            // The sum over the edges is three times the sum over the corners relative to their
            // mean.
            const std::uint32_t i = triangle[corner], j = triangle[(corner + 1) % 3];
            const Complex edge = complexOf(rest_.vertices[j] - rest_.vertices[i]);
            sum += std::conj(edge) * complexOf(intermediate[j] - intermediate[i]);
            most += std::norm(edge);
        }
        return std::abs(sum) > kCollapsed * most ? sum / std::abs(sum) : Complex(1);
    }

    FlatMesh rest_;
    glm::dvec2 middle_{0};
    std::vector<std::size_t> vertices_, handles_;            // indices in the whole shape
    Eigen::MatrixXd atRest_;                                 // of the handles
    std::optional<ConstrainedQuadratic> stepOne_, stepTwo_;  // none for a single handle
};

ShapeManipulation::ShapeManipulation(const FlatMesh& rest, std::span<const CarriedPoint> handles) : rest_(rest.vertices) {
    const std::vector<std::size_t> numbers = islandsOf(rest);
    const auto islandOf = [&](std::size_t triangle) { return numbers[rest.triangles[triangle].x]; };
    const std::size_t count = numbers.empty() ? 0 : *std::max_element(numbers.begin(), numbers.end()) + 1;
    for (std::size_t island = 0; island < count; ++island) {
        FlatMesh own;
        std::vector<std::size_t> vertices, mine;
        std::vector<CarriedPoint> points;
        std::vector<std::uint32_t> vertexHere(rest.vertices.size()), triangleHere(rest.triangles.size());
        for (std::size_t i = 0; i < rest.vertices.size(); ++i) {
            if (numbers[i] != island) continue;
            vertexHere[i] = static_cast<std::uint32_t>(vertices.size());
            vertices.push_back(i);
            own.vertices.push_back(rest.vertices[i]);
        }
        for (std::size_t i = 0; i < rest.triangles.size(); ++i) {
            if (islandOf(i) != island) continue;
            triangleHere[i] = static_cast<std::uint32_t>(own.triangles.size());
            const glm::uvec3 triangle = rest.triangles[i];
            own.triangles.emplace_back(vertexHere[triangle.x], vertexHere[triangle.y], vertexHere[triangle.z]);
        }
        for (std::size_t i = 0; i < handles.size(); ++i) {
            if (islandOf(handles[i].triangle) != island) continue;
            mine.push_back(i);
            points.push_back({triangleHere[handles[i].triangle], handles[i].shares});
        }
        if (!mine.empty())
            islands_.push_back(std::make_unique<Island>(std::move(own), std::move(vertices), std::move(points), std::move(mine)));
    }
}
ShapeManipulation::~ShapeManipulation() = default;
ShapeManipulation::ShapeManipulation(ShapeManipulation&&) noexcept = default;

std::vector<glm::dvec2> ShapeManipulation::apply(std::span<const glm::dvec2> places, bool isScaleAdjusted) const {
    std::vector<glm::dvec2> result = rest_;
    for (const auto& island : islands_) island->apply(places, isScaleAdjusted, result);
    return result;
}

std::vector<glm::dvec2> ShapeManipulation::deformed(std::span<const glm::dvec2> places) const { return apply(places, true); }

std::vector<glm::dvec2> ShapeManipulation::scaleFree(std::span<const glm::dvec2> places) const { return apply(places, false); }

}  // namespace fantascope::theatre
