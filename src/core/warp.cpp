#include "core/warp.h"

#include "core/check.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope {
namespace {

using Between = WarpMesh::Between;
using Flip = Orientation::Flip;

// Samples between two mesh points in the check for folds.
constexpr int kLooks = 8;

// The map from the canvas to the picture's square.
glm::dmat3 squareFromCanvas(const CanvasPart& part, const Orientation& orientation) {
    const glm::dvec2 scale = 1.0 / (part.high - part.low), offset = -part.low * scale;
    glm::dmat3 map(scale.x, 0, 0, 0, scale.y, 0, offset.x, offset.y, 1);
    if (orientation.flip == Flip::Horizontal) map = glm::dmat3(-1, 0, 0, 0, 1, 0, 1, 0, 1) * map;
    if (orientation.flip == Flip::Vertical) map = glm::dmat3(1, 0, 0, 0, -1, 0, 0, 1, 1) * map;
    // Clockwise as seen, y down: the left edge becomes the top one.
    for (int turn = 0; turn < orientation.quarterTurns; ++turn) map = glm::dmat3(0, 1, 0, -1, 0, 0, 1, 0, 1) * map;
    return map;
}

// The weights of four consecutive points for a place between the middle two; `share` of the way.
std::array<double, 4> weightsOf(Between between, double share) {
    const double t = share, t2 = t * t, t3 = t2 * t;
    if (between == Between::Straight) return {0, 1 - t, t, 0};
    return {(-t3 + 2 * t2 - t) / 2, (3 * t3 - 5 * t2 + 2) / 2, (-3 * t3 + 4 * t2 + t) / 2, (t3 - t2) / 2};
}

}  // namespace

glm::dvec2 WarpMesh::offsetAt(glm::dvec2 onPicture) const {
    if (offsets.empty()) return glm::dvec2(0);
    const glm::dvec2 at = glm::clamp(onPicture, 0.0, 1.0) * glm::dvec2(points - 1);
    const glm::ivec2 cell = glm::min(glm::ivec2(at), points - 2);
    const auto across = weightsOf(between, at.x - cell.x), down = weightsOf(between, at.y - cell.y);
    // Beyond the last point the lattice continues in a straight line, so that a mesh of two points
    // is one.
    const auto point = [&](int x, int y) { return offsets[static_cast<std::size_t>(y * points.x + x)]; };
    const auto along = [&](int y, int x) {
        if (x < 0) return 2.0 * point(0, y) - point(1, y);
        if (x >= points.x) return 2.0 * point(points.x - 1, y) - point(points.x - 2, y);
        return point(x, y);
    };
    const auto row = [&](int y) {
        glm::dvec2 sum(0);
        for (int i = 0; i < 4; ++i) sum += across[static_cast<std::size_t>(i)] * along(y, cell.x - 1 + i);
        return sum;
    };
    glm::dvec2 sum(0);
    for (int i = 0; i < 4; ++i) {
        const double weight = down[static_cast<std::size_t>(i)];
        const int y = cell.y - 1 + i;
        if (y < 0)
            sum += weight * (2.0 * row(0) - row(1));
        else if (y >= points.y)
            sum += weight * (2.0 * row(points.y - 1) - row(points.y - 2));
        else
            sum += weight * row(y);
    }
    return sum;
}

WarpMesh WarpMesh::resampled(glm::ivec2 count) const {
    WarpMesh result{between, count, {}};
    for (int y = 0; y < count.y; ++y)
        for (int x = 0; x < count.x; ++x) result.offsets.push_back(offsetAt(glm::dvec2(x, y) / glm::dvec2(count - 1)));
    return result;
}

WarpShape WarpShape::scaled(glm::dvec2 factor) const {
    WarpShape result = *this;
    for (glm::dvec2& corner : result.corners) corner *= factor;
    for (glm::dvec2& offset : result.mesh.offsets) offset *= factor;
    return result;
}

WarpShape WarpShape::moved(const Homography& map) const {
    WarpShape result = *this;
    for (glm::dvec2& corner : result.corners) corner = map(corner);
    const auto before = Homography::fromCorners(rectangleCorners(1, 1), corners),
               after = Homography::fromCorners(rectangleCorners(1, 1), result.corners);
    if (mesh.points.x == 0 || !before || !after) return result;
    for (int y = 0; y < mesh.points.y; ++y)
        for (int x = 0; x < mesh.points.x; ++x) {
            const glm::dvec2 on = glm::dvec2(x, y) / glm::dvec2(mesh.points - 1);
            glm::dvec2& offset = result.mesh.offsets[static_cast<std::size_t>(y * mesh.points.x + x)];
            offset = map((*before)(on) + offset) - (*after)(on);
        }
    return result;
}

Result<Warp> Warp::of(const WarpShape& shape) {
    const glm::dvec2 part = shape.part.high - shape.part.low;
    if (!(part.x > 0 && part.y > 0))
        return Error("the part of the canvas has no area: give its left and top first, then its right and bottom");
    const Homography keystone = TRY(Homography::fromCorners(rectangleCorners(1, 1), shape.corners));
    const WarpMesh& mesh = shape.mesh;
    if (mesh.points != glm::ivec2(0)) {
        if (std::min(mesh.points.x, mesh.points.y) < 2 || std::max(mesh.points.x, mesh.points.y) > WarpMesh::kMaxPoints)
            return Error(fmt::format("a mesh has 2 to {} points in each direction", WarpMesh::kMaxPoints));
        const auto wanted = static_cast<std::size_t>(mesh.points.x) * static_cast<std::size_t>(mesh.points.y);
        if (mesh.offsets.size() != wanted)
            return Error(fmt::format("a mesh of {} x {} points has {} offsets, here are {}", mesh.points.x, mesh.points.y, wanted,
                                     mesh.offsets.size()));
    } else if (!mesh.offsets.empty()) {
        return Error("the mesh has offsets, but not its number of points");
    }
    Warp warp(shape, keystone, squareFromCanvas(shape.part, shape.orientation));
    if (warp.bends() && warp.folds()) return Error("the mesh folds the picture over itself; move its points less");
    return warp;
}

Warp Warp::straight(glm::ivec2 size) { return of({.corners = rectangleCorners(size.x, size.y)}).value(); }

Warp Warp::ofPictureOn(const CanvasPart& place) const {
    const glm::dvec2 size = place.high - place.low;
    WarpShape shape = shape_;
    shape.part = {(shape.part.low - place.low) / size, (shape.part.high - place.low) / size};
    return Warp(shape, keystoneFromPicture_, squareFromCanvas(shape.part, shape.orientation));
}

CanvasPart Warp::shown() const { return {glm::max(shape_.part.low, 0.0), glm::min(shape_.part.high, 1.0)}; }

Warp::Warp(const WarpShape& shape, const Homography& keystoneFromPicture, const glm::dmat3& pictureFromCanvas)
    : shape_(shape),
      keystoneFromPicture_(keystoneFromPicture),
      pictureFromKeystone_(keystoneFromPicture.inverse()),
      pictureFromCanvas_(pictureFromCanvas),
      canvasFromPicture_(Homography(pictureFromCanvas).inverse()),
      keystone_(keystoneFromPicture * Homography(pictureFromCanvas)) {}

glm::dvec2 Warp::projectorFromPicture(glm::dvec2 onPicture) const {
    return keystoneFromPicture_(onPicture) + offsetAt(onPicture);
}

glm::dvec2 Warp::projectorFromCanvas(glm::dvec2 canvas) const { return projectorFromPicture(pictureFromCanvas_(canvas)); }

glm::dmat2 Warp::slopeAt(glm::dvec2 onPicture) const {
    constexpr double kStep = 1e-5;
    glm::dmat2 slope;
    for (int axis = 0; axis < 2; ++axis) {
        glm::dvec2 step(0);
        step[axis] = kStep;
        slope[axis] = (projectorFromPicture(onPicture + step) - projectorFromPicture(onPicture - step)) / (2 * kStep);
    }
    return slope;
}

bool Warp::folds() const {
    // Where the picture is folded, its orientation is opposite to that of its corners.
    const double round =
        glm::determinant(glm::dmat2(shape_.corners[1] - shape_.corners[0], shape_.corners[3] - shape_.corners[0]));
    const glm::ivec2 looks = kLooks * (shape_.mesh.points - 1);
    for (int y = 0; y < looks.y; ++y)
        for (int x = 0; x < looks.x; ++x)
            if (glm::determinant(slopeAt((glm::dvec2(x, y) + 0.5) / glm::dvec2(looks))) * round <= 0) return true;
    return false;
}

std::optional<glm::dvec2> Warp::canvasFromProjector(glm::dvec2 pixel) const {
    constexpr int kMaxSteps = 30;
    constexpr double kNear = 1e-6;  // pixels
    const glm::dmat3& inverse = pictureFromKeystone_.matrix();
    const auto undone = [&](glm::dvec2 keystoned) -> std::optional<glm::dvec2> {
        const glm::dvec3 mapped = inverse * glm::dvec3(keystoned, 1), corner = inverse * glm::dvec3(shape_.corners[0], 1);
        if (mapped.z * corner.z <= 0) return std::nullopt;
        return glm::dvec2(mapped) / mapped.z;
    };
    auto place = undone(pixel);
    if (!place) return std::nullopt;
    if (bends()) {
        // Newton's method, starting from the keystone alone; a step is halved while it leads
        // farther away.
        glm::dvec2 miss = pixel - projectorFromPicture(*place);
        for (int step = 0; step < kMaxSteps && glm::length(miss) > kNear; ++step) {
            const glm::dvec2 move = glm::inverse(slopeAt(*place)) * miss;
            double share = 1;
            glm::dvec2 next = *place + move, left = pixel - projectorFromPicture(next);
            while (!(glm::length(left) < glm::length(miss)) && share > 1e-3) {
                share /= 2;
                next = *place + share * move;
                left = pixel - projectorFromPicture(next);
            }
            place = next;
            miss = left;
        }
        if (!(glm::length(miss) < 1)) return std::nullopt;
    }
    return canvasFromPicture_(*place);
}

bool Warp::reaches(glm::ivec2 size) const {
    constexpr int kSide = 64;  // sampled points of the picture, across and down
    for (int i = 0; i < kSide * kSide; ++i) {
        const glm::dvec2 pixel = projectorFromPicture((glm::dvec2(i % kSide, i / kSide) + 0.5) / double(kSide));
        if (pixel.x >= 0 && pixel.y >= 0 && pixel.x < size.x && pixel.y < size.y) return true;
    }
    return false;
}

double Warp::canvasRows(double aspect) const {
    double area = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::dvec2 a = shape_.corners[i], b = shape_.corners[(i + 1) % 4];
        area += (a.x * b.y - b.x * a.y) / 2;
    }
    const glm::dvec2 part = shape_.part.high - shape_.part.low;
    return std::sqrt(std::abs(area) / (part.x * part.y) / aspect);
}

}  // namespace fantascope
