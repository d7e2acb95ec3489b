#include "theatre/deform/triangulated_silhouette.h"

#include "core/random.h"
#include "pictures.h"
#include "source_folder.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>
#include <utility>

namespace fantascope::theatre {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TriangulatedSilhouette silhouetteOf(const GreyImage& picture, int vertices = TriangulatedSilhouette::kVertices) {
    auto silhouette = TriangulatedSilhouette::of(picture, vertices);
    EXPECT_TRUE(silhouette) << silhouette.error().message();
    return std::move(silhouette).value();
}

// What two pictures share, of what either has.
double overlap(const GreyImage& a, const GreyImage& b) {
    int both = 0, either = 0;
    for (int y = 0; y < a.height(); ++y)
        for (int x = 0; x < a.width(); ++x) {
            const bool inA = a.at(x, y) > 0.5f, inB = b.at(x, y) > 0.5f;
            both += inA && inB, either += inA || inB;
        }
    return double(both) / either;
}

// Vertices less edges plus triangles: islands less holes (Euler).
int eulersNumber(const FlatMesh& mesh) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const glm::uvec3 t : mesh.triangles)
        for (int i = 0; i < 3; ++i) edges.insert(std::minmax(t[i], t[(i + 1) % 3]));
    return static_cast<int>(mesh.vertices.size()) - static_cast<int>(edges.size()) + static_cast<int>(mesh.triangles.size());
}

std::size_t islands(const FlatMesh& mesh) {
    const auto numbers = islandsOf(mesh);
    return *std::max_element(numbers.begin(), numbers.end()) + 1;
}

double leastAngle(const FlatMesh& mesh) {
    double least = 180;
    for (const glm::uvec3 t : mesh.triangles)
        for (int i = 0; i < 3; ++i) {
            const glm::dvec2 a = mesh.vertices[t[(i + 1) % 3]] - mesh.vertices[t[i]],
                             b = mesh.vertices[t[(i + 2) % 3]] - mesh.vertices[t[i]];
            least = std::min(least, std::acos(glm::dot(a, b) / glm::length(a) / glm::length(b)) * 180 / std::numbers::pi);
        }
    return least;
}

// A ring of 50 pixels' radius, with a bar beside it.
GreyImage ringAndBar() {
    return pictureOf(240, 140, [](int x, int y) {
        const double r = std::hypot(x + 0.5 - 70, y + 0.5 - 70);
        return (r < 50 && r > 25) || isIn(x, y, 160, 20, 40, 100);
    });
}

TEST(TriangulatedSilhouette, of_each_of_the_projects_drawings_is_well_triangulated_and_shows_the_drawing) {
    int pictures = 0;
    for (const auto& file : std::filesystem::directory_iterator(sourceFolder() + "/assets/silhouettes")) {
        if (file.path().extension() != ".png") continue;
        SCOPED_TRACE(file.path().filename());
        ++pictures;
        const GreyImage picture = readGrey(file.path()).value();
        const TriangulatedSilhouette silhouette = silhouetteOf(picture);
        EXPECT_THAT(silhouette.rest.vertices.size(), AllOf(testing::Ge(240u), testing::Le(350u)));
        EXPECT_GT(leastAngle(silhouette.rest), 17);
        EXPECT_EQ(eulersNumber(silhouette.rest), 1);
        EXPECT_TRUE(foldedTriangles(silhouette.rest, silhouette.rest.vertices).empty());
        const GreyImage again = drawn(silhouette.outlineAt(silhouette.rest.vertices), picture.width(), picture.height());
        EXPECT_GT(overlap(picture, again), 0.995);
    }
    EXPECT_EQ(pictures, 13);
}

TEST(TriangulatedSilhouette, has_about_as_many_vertices_as_are_wanted) {
    for (const int wanted : {60, 1000, 4000})
        EXPECT_NEAR(static_cast<double>(silhouetteOf(ringAndBar(), wanted).rest.vertices.size()), wanted, 0.12 * wanted);
}

// Example failure: the mesh of a ring fills its hole, and what is in there moves along.
TEST(TriangulatedSilhouette, keeps_islands_and_holes) {
    const TriangulatedSilhouette silhouette = silhouetteOf(ringAndBar());
    EXPECT_EQ(islands(silhouette.rest), 2u);
    EXPECT_EQ(eulersNumber(silhouette.rest), 2 - 1);
    EXPECT_EQ(silhouette.outline.size(), 3u);
    EXPECT_GT(overlap(ringAndBar(), drawn(silhouette.outlineAt(silhouette.rest.vertices), 240, 140)), 0.995);
}

// Coarse triangles would join islands that are close, and cut what hangs together by a thread.
TEST(TriangulatedSilhouette, what_is_close_stays_apart_and_what_is_thin_stays_whole) {
    const auto wave = [](int at) { return static_cast<int>(std::lround(5 * std::sin(at * 0.16))); };
    const TriangulatedSilhouette close = silhouetteOf(
        pictureOf(200, 160,
                  [&](int x, int y) { return isIn(x, y, 20, 20, 160, 120) && x != 100 + wave(y) && x != 101 + wave(y); }),
        30);
    EXPECT_EQ(islands(close.rest), 2u);
    EXPECT_EQ(eulersNumber(close.rest), 2);
    const TriangulatedSilhouette thin = silhouetteOf(pictureOf(200, 160,
                                                               [&](int x, int y) {
                                                                   const int away = y - 80 - wave(x);
                                                                   return isIn(x, y, 20, 20, 40, 120) ||
                                                                          isIn(x, y, 140, 20, 40, 120) ||
                                                                          (x > 30 && x < 170 && (away == 0 || away == 1));
                                                               }),
                                                     30);
    EXPECT_EQ(islands(thin.rest), 1u);
    EXPECT_EQ(eulersNumber(thin.rest), 1);
}

// A thin line of light grey is less than half light wherever the picture is smoothed.
TEST(TriangulatedSilhouette, a_line_one_pixel_wide_is_there) {
    GreyImage picture = pictureOf(160, 150, [](int x, int y) { return isIn(x, y, 10, 20, 40, 80); });
    for (int y = 10; y < 140; ++y) picture.at(100, y) = 0.7f;
    const TriangulatedSilhouette silhouette = silhouetteOf(picture);
    EXPECT_EQ(islands(silhouette.rest), 2u);
    EXPECT_EQ(silhouette.outline.size(), 2u);
    EXPECT_GT(overlap(picture, drawn(silhouette.outlineAt(silhouette.rest.vertices), 160, 150)), 0.98);
}

TEST(TriangulatedSilhouette, carries_any_point_by_the_triangle_at_it_or_nearest_to_it) {
    const TriangulatedSilhouette silhouette = silhouetteOf(ringAndBar());
    for (const glm::dvec2 point : {glm::dvec2(70, 30), {70, 70}, {30, 60}, {180.3, 99.9}, {-20, 300}, {159, 50}}) {
        const CarriedPoint carrier = silhouette.carried(point);
        EXPECT_LT(glm::distance(silhouette.placeOf(carrier, silhouette.rest.vertices), point), 1e-9);
        EXPECT_NEAR(carrier.shares.x + carrier.shares.y + carrier.shares.z, 1, 1e-12);
    }
    EXPECT_LT(glm::distance(silhouette.nearest({180, 60}), {180, 60}), 1e-12);
    EXPECT_LT(glm::distance(silhouette.nearest({230, 60}), {200, 60}), 0.6);
    // All triangles moved: so is what they carry, be it outside.
    std::vector<glm::dvec2> moved = silhouette.rest.vertices;
    for (glm::dvec2& vertex : moved) vertex += glm::dvec2(3, -2);
    EXPECT_LT(glm::distance(silhouette.placeOf(silhouette.carried({159, 50}), moved), {162, 48}), 1e-9);
}

// Whatever somebody scribbles. Example failure: an island is lost, or two grow together, only at
// certain sizes of triangles.
TEST(TriangulatedSilhouette, of_blots_is_as_many_islands_as_are_drawn) {
    Rng rng(11);
    int tried = 0;
    while (tried < 20) {
        GreyImage noise(120, 100);
        for (float& value : noise.pixels()) value = static_cast<float>(rng.uniform());
        const GreyImage soft = blurred(noise, rng.uniform(3, 9));
        const GreyImage blots = pictureOf(120, 100, [&](int x, int y) { return soft.at(x, y) > 0.5f; });
        const auto silhouette = TriangulatedSilhouette::of(blots, std::array{20, 100, 600}[static_cast<std::size_t>(tried % 3)]);
        if (!silhouette) continue;  // there is a speck
        ++tried;
        const Outline outline = silhouette->outlineAt(silhouette->rest.vertices);
        const auto drawnIslands = std::count_if(outline.rings.begin(), outline.rings.end(), [](const auto& ring) {
            double area = 0;
            for (std::size_t i = 0; i < ring.size(); ++i) {
                const glm::dvec2 a = ring[i], b = ring[(i + 1) % ring.size()];
                area += a.x * b.y - a.y * b.x;
            }
            return area > 0;
        });
        EXPECT_EQ(islands(silhouette->rest), static_cast<std::size_t>(drawnIslands));
        EXPECT_TRUE(foldedTriangles(silhouette->rest, silhouette->rest.vertices).empty());
        EXPECT_GT(overlap(blots, drawn(outline, 120, 100)), 0.98);
    }
}

// The light ends where the picture does.
TEST(TriangulatedSilhouette, may_reach_the_pictures_edge) {
    const GreyImage picture = pictureOf(80, 60, [](int x, int) { return x < 40; });
    const TriangulatedSilhouette silhouette = silhouetteOf(picture);
    const GreyImage again = drawn(silhouette.outlineAt(silhouette.rest.vertices), 80, 60);
    EXPECT_EQ(overlap(picture, again), 1);
    EXPECT_GT(again.at(20, 0), 0.97f);
    EXPECT_GT(again.at(0, 59), 0.6f) << "its corner is rounded a little";
}

TEST(TriangulatedSilhouette, is_refused_if_there_is_nothing_to_move_or_too_much) {
    const auto refusal = [](const GreyImage& picture) {
        const auto silhouette = TriangulatedSilhouette::of(picture);
        return silhouette ? "read" : silhouette.error().message();
    };
    EXPECT_THAT(refusal(GreyImage(50, 50)), HasSubstr("nothing in it is white"));
    EXPECT_THAT(refusal(GreyImage(50, 50, 1.0f)), HasSubstr("all of it is white"));
    EXPECT_THAT(refusal(GreyImage(3000, 10)), HasSubstr("3000 x 10 pixels; no side may have more than 2048"));
    EXPECT_THAT(refusal(pictureOf(100, 100, [](int x, int y) { return isIn(x, y, 10, 10, 60, 60) || (x == 90 && y == 80); })),
                AllOf(HasSubstr("column 9"), HasSubstr("row 80"), HasSubstr("speck"), HasSubstr("remove it")));
    EXPECT_THAT(refusal(pictureOf(200, 200, [](int x, int y) { return x % 10 != 0 || y % 10 != 0; })),
                AllOf(HasSubstr("islands and holes"), HasSubstr("200")));
}

TEST(FoldedTriangles, are_those_turned_over_and_those_without_area) {
    const FlatMesh mesh{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{0, 1, 2}, {0, 2, 3}}};
    EXPECT_THAT(foldedTriangles(mesh, mesh.vertices), testing::IsEmpty());
    EXPECT_THAT(foldedTriangles(mesh, std::vector<glm::dvec2>{{0, 0}, {1, 0}, {1, 1}, {2, 1}}), testing::ElementsAre(1u));
    EXPECT_THAT(foldedTriangles(mesh, std::vector<glm::dvec2>{{0, 0}, {0.5, 0.5}, {1, 1}, {0, 1}}), testing::ElementsAre(0u));
    EXPECT_THAT(foldedTriangles(mesh, std::vector<glm::dvec2>{{0, 0}, {-1, 0}, {-1, 1}, {0, 1}}), testing::ElementsAre(0u, 1u));
}

}  // namespace
}  // namespace fantascope::theatre
