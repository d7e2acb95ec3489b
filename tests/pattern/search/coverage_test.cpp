#include "pattern/search/coverage.h"

#include "pattern/shape/built_in_shapes.h"
#include "pattern/shape/elemental_shape.h"

#include "core/random.h"
#include "source_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace fantascope::pattern {
namespace {

// Where the centre of a pixel lies relative to a triangle.
enum class Where { Inside, Outside, OnTheEdge };

// By the signs of three cross products. Within a millionth of a pixel from an edge, either side is
// right.
Where whereIs(glm::dvec2 point, glm::dvec2 a, glm::dvec2 b, glm::dvec2 c) {
    const auto distance = [&](glm::dvec2 from, glm::dvec2 to) {
        const glm::dvec2 along = to - from, out = point - from;
        return (along.x * out.y - along.y * out.x) / std::max(std::hypot(along.x, along.y), 1e-12);
    };
    const double ab = distance(a, b), bc = distance(b, c), ca = distance(c, a);
    const double least = std::min({ab, bc, ca}), greatest = std::max({ab, bc, ca});
    if (least > 1e-6 || greatest < -1e-6) return Where::Inside;
    if (least < -1e-6 && greatest > 1e-6) return Where::Outside;
    return Where::OnTheEdge;
}

// Compares every pixel of one instance with a test of its centre against every triangle.
void expectAsBruteForce(const TriangleMesh& mesh, const InstancePose& pose, int width, int height) {
    Coverage coverage(width, height);
    coverage.add(Silhouette(mesh), pose);
    std::vector<glm::dvec2> corners;
    for (const glm::vec3& vertex : mesh.vertices)
        corners.push_back((pose.centre + glm::dvec2(canvasFromShape(pose) * glm::dvec3(vertex))) * double(height));
    int undecided = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            bool inside = false, onTheEdge = false;
            for (const glm::uvec3& t : mesh.triangles) {
                const Where where = whereIs({x + 0.5, y + 0.5}, corners[t.x], corners[t.y], corners[t.z]);
                inside = inside || where == Where::Inside;
                onTheEdge = onTheEdge || where == Where::OnTheEdge;
            }
            if (onTheEdge && !inside)
                ++undecided;
            else
                ASSERT_EQ(coverage.at(x, y), inside) << "pixel " << x << ", " << y;
        }
    EXPECT_LT(undecided, 5);
}

InstancePose randomPose(Rng& rng) {
    return {{rng.uniform(-0.3, 1.8), rng.uniform(-0.3, 1.3)},
            rng.uniform(0.02, 0.6),
            {rng.uniform(-1.5, 1.5), rng.uniform(-1.5, 1.5), rng.uniform(-3.1, 3.1)}};
}

TriangleMesh soup(Rng& rng, int triangles) {
    TriangleMesh mesh;
    const auto coordinate = [&] { return static_cast<float>(rng.uniform(-0.7, 0.7)); };
    for (int i = 0; i < 3 * triangles; ++i) mesh.vertices.emplace_back(coordinate(), coordinate(), coordinate());
    for (std::uint32_t i = 0; i < mesh.vertices.size(); i += 3) mesh.triangles.emplace_back(i, i + 1, i + 2);
    return mesh;
}

// The centre at `centre` in pixels of a picture that is `height` pixels high, one canvas unit a
// pixel times `size`.
InstancePose poseInPixels(glm::dvec2 centre, double size, int height) { return {centre / double(height), size / height, {}}; }

// A square whose corners are at +-1, as two triangles.
TriangleMesh unitSquare() { return {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}}; }

TEST(Coverage, is_what_a_test_of_every_pixel_against_every_triangle_gives) {
    Rng rng(1);
    for (const int width : {64, 100, 130}) {  // multiples of a word, and others
        for (const std::string& shape : builtInShapeNames())
            for (int i = 0; i < 6; ++i) expectAsBruteForce(loadShape(shape)->mesh, randomPose(rng), width, 60);
        // Triangles that share no corner, cross each other and face either way.
        for (int i = 0; i < 6; ++i) expectAsBruteForce(soup(rng, 5), randomPose(rng), width, 60);
    }
}

// A closed surface seen from all sides: inner edges cancel out, and the far side is hidden.
// Example failure: an edge between a front face and a back face is skipped, and the silhouette
// opens there.
TEST(Coverage, of_a_rotated_solid_is_its_whole_silhouette) {
    const auto sculpture = loadShape(sourceFolder() + "/shows/light-movement/shapes/sculpture.obj");
    ASSERT_TRUE(sculpture) << sculpture.error().message();
    Rng rng(2);
    for (int i = 0; i < 30; ++i) expectAsBruteForce(sculpture->mesh, randomPose(rng), 100, 60);
}

// Adjacent triangles must neither leave a dark seam nor count a pixel twice. Example failure: both
// round the common edge outwards.
TEST(Coverage, gives_each_pixel_of_a_common_edge_to_one_triangle) {
    // The edges run exactly through pixel centres, where rounding decides nothing.
    Coverage one(64, 64), other(64, 64), both(64, 64);
    const TriangleMesh lower{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}}, {{0, 1, 2}}};
    const TriangleMesh upper{{{-1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}}};
    const InstancePose pose = poseInPixels({30.5, 30.5}, 16, 64);
    one.add(Silhouette(lower), pose);
    other.add(Silhouette(upper), pose);
    both.add(Silhouette(unitSquare()), pose);
    const PixelRectangle all{{0, 0}, {64, 64}};
    EXPECT_EQ(both.count(all), 32 * 32);
    EXPECT_EQ(one.count(all) + other.count(all), both.count(all));
    EXPECT_TRUE(both.at(30, 30));
}

TEST(Coverage, unites_what_overlaps) {
    Coverage coverage(80, 60);
    const Silhouette square(unitSquare());
    coverage.add(square, poseInPixels({20, 20}, 10, 60));
    coverage.add(square, poseInPixels({25, 20}, 10, 60));
    coverage.add(square, poseInPixels({25, 20}, 10, 60));
    EXPECT_EQ(coverage.count({{0, 0}, {80, 60}}), 25 * 20);
}

TEST(Coverage, ends_at_the_border_of_the_picture) {
    Coverage coverage(80, 60);
    const Silhouette square(unitSquare());
    for (const glm::dvec2 beyond : {glm::dvec2(-30, 30), glm::dvec2(110, 30), glm::dvec2(40, -30), glm::dvec2(40, 90)})
        coverage.add(square, poseInPixels(beyond, 10, 60));
    EXPECT_EQ(coverage.count({{0, 0}, {80, 60}}), 0);
    coverage.add(square, poseInPixels({0, 0}, 10, 60));
    EXPECT_EQ(coverage.count({{0, 0}, {80, 60}}), 100);
    coverage.add(square, poseInPixels({40, 30}, 1000, 60));
    EXPECT_EQ(coverage.count({{0, 0}, {80, 60}}), 80 * 60);
}

TEST(Coverage, counts_and_runs_tell_the_same_as_the_pixels) {
    for (const int width : {64, 65, 128, 150}) {
        Coverage coverage(width, 40);
        Rng rng(3);
        for (int i = 0; i < 12; ++i) coverage.add(Silhouette(soup(rng, 2)), {{rng.uniform(0, 3.5), rng.uniform()}, 0.3, {}});
        coverage.add(Silhouette(unitSquare()), poseInPixels({width / 2.0, 5}, width, 40));  // whole rows, across words

        Image<std::uint8_t> fromRuns(width, 40);
        int lastRow = 0, lastEnd = -1;
        coverage.forEachRun([&](int y, int begin, int end) {
            ASSERT_TRUE(y > lastRow || begin > lastEnd) << "runs are in order and do not touch";
            lastRow = y, lastEnd = end;
            for (int x = begin; x < end; ++x) fromRuns.at(x, y) = 1;
        });
        for (int y = 0; y < 40; ++y)
            for (int x = 0; x < width; ++x) ASSERT_EQ(fromRuns.at(x, y) == 1, coverage.at(x, y)) << x << ", " << y;

        for (int i = 0; i < 50; ++i) {
            const glm::ivec2 a(rng.below(static_cast<std::uint32_t>(width) + 1), rng.below(41)),
                b(rng.below(static_cast<std::uint32_t>(width) + 1), rng.below(41));
            const PixelRectangle cell{glm::min(a, b), glm::max(a, b)};
            std::int64_t expected = 0;
            for (int y = cell.begin.y; y < cell.end.y; ++y)
                for (int x = cell.begin.x; x < cell.end.x; ++x) expected += fromRuns.at(x, y);
            ASSERT_EQ(coverage.count(cell), expected);
        }
        coverage.clear();
        EXPECT_EQ(coverage.count({{0, 0}, {width, 40}}), 0);
    }
}

}  // namespace
}  // namespace fantascope::pattern
