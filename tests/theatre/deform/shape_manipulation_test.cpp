#include "theatre/deform/shape_manipulation.h"

#include "core/random.h"
#include "pictures.h"

#include <Eigen/Dense>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fantascope::theatre {
namespace {

using Points = std::vector<glm::dvec2>;

TriangulatedSilhouette silhouetteOf(const GreyImage& picture, int vertices = TriangulatedSilhouette::kVertices) {
    return TriangulatedSilhouette::of(picture, vertices).value();
}
// A bar of 200 x 30 pixels, its middle at (150, 85).
TriangulatedSilhouette bar() {
    return silhouetteOf(pictureOf(300, 170, [](int x, int y) { return isIn(x, y, 50, 70, 200, 30); }));
}
std::vector<CarriedPoint> carriedBy(const TriangulatedSilhouette& silhouette, const Points& points) {
    std::vector<CarriedPoint> carried;
    for (const glm::dvec2 point : points) carried.push_back(silhouette.carried(point));
    return carried;
}
ShapeManipulation manipulationOf(const TriangulatedSilhouette& silhouette, const Points& handles) {
    return {silhouette.rest, carriedBy(silhouette, handles)};
}

// About the origin, then moved.
struct Movement {
    double angle;
    glm::dvec2 by;
    glm::dvec2 operator()(glm::dvec2 p) const {
        return glm::dvec2(std::cos(angle) * p.x - std::sin(angle) * p.y, std::sin(angle) * p.x + std::cos(angle) * p.y) + by;
    }
    Points operator()(Points points) const {
        for (glm::dvec2& point : points) point = (*this)(point);
        return points;
    }
};

double farthest(const Points& a, const Points& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, glm::distance(a[i], b[i]));
    return most;
}

double areaOf(const FlatMesh& mesh, const Points& vertices) {
    double area = 0;
    for (const glm::uvec3& t : mesh.triangles) area += doubleArea(t, vertices) / 2;
    return area;
}
// How much the triangles' areas differ from those at rest, as a share of all.
double areaChange(const FlatMesh& mesh, const Points& vertices) {
    double change = 0;
    for (const glm::uvec3& t : mesh.triangles) change += std::abs(doubleArea(t, vertices) - doubleArea(t, mesh.vertices)) / 2;
    return change / areaOf(mesh, mesh.vertices);
}

Points randomPoints(std::size_t count, double size, Rng& rng) {
    Points points;
    for (std::size_t i = 0; i < count; ++i) {
        const double x = size * rng.uniform();
        points.emplace_back(x, size * rng.uniform());
    }
    return points;
}

// Equations 1 to 3 of the paper, word by word.
double papersFirstError(const FlatMesh& rest, const Points& v) {
    double error = 0;
    for (const glm::uvec3& t : rest.triangles)
        for (int corner = 0; corner < 3; ++corner) {
            const std::size_t i0 = t[corner], i1 = t[(corner + 1) % 3], i2 = t[(corner + 2) % 3];
            const auto right = [](glm::dvec2 p) { return glm::dvec2(-p.y, p.x); };
            const glm::dvec2 along = rest.vertices[i1] - rest.vertices[i0], to = rest.vertices[i2] - rest.vertices[i0];
            const double x01 = glm::dot(to, along) / glm::dot(along, along),
                         y01 = glm::dot(to, right(along)) / glm::dot(along, along);
            const glm::dvec2 desired = v[i0] + x01 * (v[i1] - v[i0]) + y01 * right(v[i1] - v[i0]);
            error += glm::dot(desired - v[i2], desired - v[i2]);
        }
    return error;
}

// Section 4.2: the similarity that fits the corners best, by general least squares, brought to the
// triangle's own size; then the edges' errors.
double papersSecondError(const FlatMesh& rest, const Points& intermediate, const Points& v) {
    double error = 0;
    for (const glm::uvec3& t : rest.triangles) {
        Eigen::MatrixXd a(6, 4);
        Eigen::VectorXd b(6);
        for (int i = 0; i < 3; ++i) {
            const glm::dvec2 p = rest.vertices[t[i]], q = intermediate[t[i]];
            a.row(2 * i) << p.x, -p.y, 1, 0;
            a.row(2 * i + 1) << p.y, p.x, 0, 1;
            b(2 * i) = q.x, b(2 * i + 1) = q.y;
        }
        const Eigen::VectorXd fit = a.colPivHouseholderQr().solve(b);
        const double scale = std::hypot(fit(0), fit(1));
        for (int i = 0; i < 3; ++i) {
            const glm::dvec2 p = rest.vertices[t[(i + 1) % 3]] - rest.vertices[t[i]];
            const glm::dvec2 fitted = glm::dvec2(fit(0) * p.x - fit(1) * p.y, fit(1) * p.x + fit(0) * p.y) / scale;
            const glm::dvec2 away = v[t[(i + 1) % 3]] - v[t[i]] - fitted;
            error += glm::dot(away, away);
        }
    }
    return error;
}

TEST(ScaleFreeError, is_the_papers_sum_over_triangles_and_corners) {
    const FlatMesh rest = bar().rest;
    const Eigen::SparseMatrix<double> form = scaleFreeError(rest);
    Rng rng(3);
    for (int round = 0; round < 5; ++round) {
        const Points v = randomPoints(rest.vertices.size(), 200, rng);
        Eigen::VectorXd stacked(static_cast<Eigen::Index>(2 * v.size()));
        for (std::size_t i = 0; i < v.size(); ++i) stacked.segment<2>(static_cast<Eigen::Index>(2 * i)) << v[i].x, v[i].y;
        const double wanted = papersFirstError(rest, v);
        EXPECT_NEAR(stacked.dot(form * stacked), wanted, 1e-10 * wanted);
    }
}

// Both steps end in the least of their error that the handles allow: no step away from there, on
// any side, makes it less. Handles are corners here, so that all other vertices are free.
TEST(ShapeManipulation, each_step_finds_the_least_of_the_papers_error) {
    const TriangulatedSilhouette silhouette = bar();
    const FlatMesh& rest = silhouette.rest;
    std::vector<CarriedPoint> handles;
    std::vector<std::size_t> held;
    for (const std::uint32_t triangle : {5u, 100u, 250u}) {
        handles.push_back({triangle, {1, 0, 0}});
        held.push_back(rest.triangles[triangle].x);
    }
    const ShapeManipulation manipulation(rest, handles);
    Rng rng(7);
    const Points places = randomPoints(3, 150, rng), one = manipulation.scaleFree(places), two = manipulation.deformed(places);
    EXPECT_GT(farthest(one, two), 1) << "the steps differ";
    for (int round = 0; round < 20; ++round) {
        Points direction = randomPoints(one.size(), 1, rng);
        for (const std::size_t i : held) direction[i] = {0, 0};
        const auto along = [&](Points v, double far) {
            for (std::size_t i = 0; i < v.size(); ++i)
                v[i] += far * (direction[i] - 0.5 * glm::dvec2(direction[i] != glm::dvec2(0)));
            return v;
        };
        // A parabola's arms are of one height at its lowest point.
        const double oneBefore = papersFirstError(rest, along(one, -1)), oneAfter = papersFirstError(rest, along(one, 1));
        EXPECT_NEAR(oneBefore, oneAfter, 1e-8 * oneAfter);
        const double twoBefore = papersSecondError(rest, one, along(two, -1)),
                     twoAfter = papersSecondError(rest, one, along(two, 1));
        EXPECT_NEAR(twoBefore, twoAfter, 1e-8 * twoAfter);
    }
}

TEST(ShapeManipulation, a_rigid_movement_of_the_handles_moves_the_whole_rigidly) {
    const TriangulatedSilhouette silhouette = bar();
    const Points handles = {{60.3, 85}, {150, 77.7}, {241, 92.1}};
    const ShapeManipulation manipulation = manipulationOf(silhouette, handles);
    for (const Movement& movement : {Movement{0, {0, 0}}, {0, {40, -3}}, {0.4, {10, 10}}, {2.9, {-300, 800}}}) {
        EXPECT_LT(farthest(manipulation.deformed(movement(handles)), movement(silhouette.rest.vertices)), 1e-9);
        EXPECT_LT(farthest(manipulation.scaleFree(movement(handles)), movement(silhouette.rest.vertices)), 1e-9);
    }
}

TEST(ShapeManipulation, handles_anywhere_in_the_triangles_reach_their_places) {
    const TriangulatedSilhouette silhouette = bar();
    const Points handles = {{61.7, 80.1}, {149, 90.2}, {237.5, 76}};
    const ShapeManipulation manipulation = manipulationOf(silhouette, handles);
    Rng rng(5);
    for (int round = 0; round < 5; ++round) {
        const Points places = randomPoints(3, 300, rng), vertices = manipulation.deformed(places);
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_LT(glm::distance(silhouette.placeOf(silhouette.carried(handles[i]), vertices), places[i]), 1e-9);
    }
}

TEST(ShapeManipulation, one_handle_moves_the_whole) {
    const TriangulatedSilhouette silhouette = bar();
    const Points vertices = manipulationOf(silhouette, {{100, 80}}).deformed(Points{{110, 60}});
    EXPECT_LT(farthest(vertices, Movement{0, {10, -20}}(silhouette.rest.vertices)), 1e-9);
}

// Example failure: step one alone, which makes twice as much of a shape whose handles are twice as
// far apart.
TEST(ShapeManipulation, handles_that_turn_or_part_do_not_scale_the_shape) {
    const TriangulatedSilhouette silhouette = bar();
    const double atRest = areaOf(silhouette.rest, silhouette.rest.vertices);
    const ShapeManipulation manipulation = manipulationOf(silhouette, {{120, 85}, {180, 85}});
    const Points turned = {{150 - 30 * std::cos(1.2), 85 - 30 * std::sin(1.2)},
                           {150 + 30 * std::cos(1.2), 85 + 30 * std::sin(1.2)}};
    EXPECT_NEAR(areaOf(silhouette.rest, manipulation.deformed(turned)) / atRest, 1, 1e-9);
    const Points parted = {{90, 85}, {210, 85}};
    EXPECT_NEAR(areaOf(silhouette.rest, manipulation.scaleFree(parted)) / atRest, 4, 0.01);
    EXPECT_LT(areaOf(silhouette.rest, manipulation.deformed(parted)) / atRest, 1.4);
    // The ends beyond the handles keep their size: the bar is as much longer as the handles are
    // farther apart.
    double left = 300, right = 0;
    for (const glm::dvec2 vertex : manipulation.deformed(parted))
        left = std::min(left, vertex.x), right = std::max(right, vertex.x);
    EXPECT_NEAR(right - left, 200 + 60, 8);
}

// The paper's figure 8, in numbers.
TEST(ShapeManipulation, a_bent_bar_keeps_its_triangles_areas) {
    const TriangulatedSilhouette silhouette = bar();
    const ShapeManipulation manipulation = manipulationOf(silhouette, {{60, 85}, {150, 85}, {240, 85}});
    // Its ends go up by 50 degrees, and no farther from the middle.
    const double angle = 50 * std::numbers::pi / 180;
    const Points bent = {{150 - 90 * std::cos(angle), 85 - 90 * std::sin(angle)},
                         {150, 85},
                         {150 + 90 * std::cos(angle), 85 - 90 * std::sin(angle)}};
    EXPECT_LT(areaChange(silhouette.rest, manipulation.deformed(bent)), 0.1);
    EXPECT_GT(areaChange(silhouette.rest, manipulation.scaleFree(bent)), 0.2);
    EXPECT_THAT(foldedTriangles(silhouette.rest, manipulation.deformed(bent)), testing::IsEmpty());
}

TEST(ShapeManipulation, an_island_without_handles_stays_and_each_follows_its_own) {
    const TriangulatedSilhouette silhouette = silhouetteOf(pictureOf(300, 100, [](int x, int y) {
        return isIn(x, y, 10, 20, 60, 60) || isIn(x, y, 110, 20, 60, 60) || isIn(x, y, 210, 20, 60, 60);
    }));
    const Points handles = {{20, 50}, {60, 50}, {140, 50}};
    const Movement turn{0.5, {30, 0}};
    const Points vertices =
        manipulationOf(silhouette, handles).deformed(Points{turn(handles[0]), turn(handles[1]), handles[2] + glm::dvec2(5, 7)});
    int turned = 0, moved = 0, stayed = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const glm::dvec2 rest = silhouette.rest.vertices[i];
        const glm::dvec2 wanted = rest.x < 90 ? turn(rest) : rest.x < 190 ? rest + glm::dvec2(5, 7) : rest;
        EXPECT_LT(glm::distance(vertices[i], wanted), 1e-9);
        ++(rest.x < 90 ? turned : rest.x < 190 ? moved : stayed);
    }
    EXPECT_TRUE(turned > 20 && moved > 20 && stayed > 20);
    EXPECT_EQ(manipulationOf(silhouette, {}).deformed(Points{}), silhouette.rest.vertices);
}

// Three corners cannot follow five handles, unless these move as one.
TEST(ShapeManipulation, more_handles_than_a_triangle_can_follow_are_followed_as_well_as_can_be) {
    const TriangulatedSilhouette silhouette = bar();
    const FlatMesh& rest = silhouette.rest;
    std::vector<CarriedPoint> handles;
    Points at;
    for (const glm::dvec3 shares :
         {glm::dvec3(0.8, 0.1, 0.1), {0.1, 0.8, 0.1}, {0.1, 0.1, 0.8}, {0.4, 0.3, 0.3}, {0.2, 0.5, 0.3}}) {
        handles.push_back({40, shares});
        at.push_back(silhouette.placeOf(handles.back(), rest.vertices));
    }
    const ShapeManipulation manipulation(rest, handles);
    const Movement movement{0.7, {20, -5}};
    EXPECT_LT(farthest(manipulation.deformed(movement(at)), movement(rest.vertices)), 1e-8);
    Points torn = at;
    torn[3] += glm::dvec2(4, 0);
    const Points vertices = manipulation.deformed(torn);
    for (std::size_t i = 0; i < at.size(); ++i)
        EXPECT_LT(glm::distance(silhouette.placeOf(handles[i], vertices), torn[i]), 4)
            << "none is worse off than the one that was torn away";
}

TEST(ShapeManipulation, handles_brought_to_one_point_give_finite_places) {
    const TriangulatedSilhouette silhouette = bar();
    for (const glm::dvec2 vertex : manipulationOf(silhouette, {{60, 85}, {240, 85}}).deformed(Points{{150, 85}, {150, 85}})) {
        EXPECT_TRUE(std::isfinite(vertex.x) && std::isfinite(vertex.y));
        EXPECT_LT(glm::distance(vertex, {150, 85}), 400);
    }
}

}  // namespace
}  // namespace fantascope::theatre
