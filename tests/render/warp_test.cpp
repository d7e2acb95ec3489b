// Every kind of warp in the pictures that go to a projector.

#include "render/reference_picture.h"
#include "render/scene.h"

#include "core/random.h"

#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <gmock/gmock.h>

#include <cmath>

namespace fantascope::render {
namespace {

using Flip = Orientation::Flip;

constexpr glm::ivec2 kSize{640, 360};

// A wall like a sail: points move by up to a fifteenth of the picture's height, unevenly.
WarpMesh sail() {
    WarpMesh mesh{WarpMesh::Between::Smooth, {5, 4}, {}};
    Rng rng(11);
    for (int i = 0; i < 20; ++i) {
        const double x = rng.uniform(-24, 24), y = rng.uniform(-24, 24);
        mesh.offsets.emplace_back(x, y);
    }
    return mesh;
}

// So far inside that the sail's corners stay in the picture.
std::array<glm::dvec2, 4> inside() {
    std::array<glm::dvec2, 4> corners = keystone(kSize);
    for (glm::dvec2& corner : corners) corner = glm::mix(glm::dvec2(kSize) / 2.0, corner, 0.85);
    return corners;
}

struct Named {
    const char* name;
    WarpShape shape;
};
const std::vector<Named>& warps() {
    static const std::vector<Named> all = {
        {"keystone", {.corners = keystone(kSize)}},
        {"part", {.part = {{0.3, 0.2}, {0.8, 1}}, .corners = keystone(kSize)}},
        {"mirrored", {.orientation = {Flip::Horizontal, 0}, .corners = keystone(kSize)}},
        {"on its side", {.orientation = {Flip::None, 1}, .corners = keystone(kSize)}},
        {"mesh", {.corners = inside(), .mesh = sail()}},
        {"all of it", {.part = {{0.1, 0}, {0.9, 0.9}}, .orientation = {Flip::Vertical, 3}, .corners = inside(), .mesh = sail()}},
    };
    return all;
}

Projection projectionBy(const WarpShape& shape) {
    Projection projection{kSize, Warp::of(shape).value()};
    projection.light.dither = false;
    return projection;
}

std::vector<pattern::InstancePose> restingPoses(const pattern::ShapePattern& pattern) {
    std::vector<pattern::InstancePose> poses;
    for (const pattern::ShapeInstance& instance : pattern.instances)
        poses.push_back({instance.centre, instance.size, instance.rotation});
    return poses;
}

// Shapes go straight through each warp: 4/255 rms against 25 points a pixel, with the renderer's 4
// samples.
TEST(Warped, patterns_are_what_a_point_by_point_reference_draws) {
    const pattern::ShapePattern pattern = smallPattern();
    for (const auto& [name, shape] : warps()) {
        const Projection projection = projectionBy(shape);
        DrawnOutput output(projection, {resting(pattern)});
        const RgbaImage& drawn = output.frame({{0, 1}});
        const Difference apart = difference(drawn, referencePicture(pattern, restingPoses(pattern), projection.warp, kSize, 5));
        std::printf("%s: rms %.2f of 255\n", name, apart.rms);
        EXPECT_LE(apart.rms, 4) << name;
    }
}

// How much of each pixel the canvas's part covers, by 8 x 8 points.
GreyImage coverageOf(const Warp& warp) {
    constexpr int kSide = 8;
    GreyImage coverage(kSize.x, kSize.y);
    const CanvasUnderPixels under(warp, kSize);
    for (int y = 0; y < kSize.y; ++y)
        for (int x = 0; x < kSize.x; ++x)
            for (int i = 0; i < kSide * kSide; ++i)
                if (under.at(glm::dvec2(x, y) + glm::dvec2(i % kSide + 0.5, i / kSide + 0.5) / static_cast<double>(kSide)))
                    coverage.at(x, y) += 1.0f / (kSide * kSide);
    return coverage;
}

// What is drawn as a picture of the canvas is bent as exactly: a plain colour lights the warped
// part, and its edges lie within a tenth of a pixel. Example failure: a mesh whose patches are
// drawn as single quadrilaterals.
TEST(Warped, a_canvas_ends_where_its_warp_says) {
    for (const auto& [name, shape] : warps()) {
        const Projection projection = projectionBy(shape);
        DrawnOutput output(projection, {SolidSource{}});
        const RgbaImage& drawn = output.frame({{0, 1}});
        const GreyImage wanted = coverageOf(projection.warp);
        double missing = 0, edge = 0;
        for (int y = 0; y < kSize.y; ++y)
            for (int x = 0; x < kSize.x; ++x) {
                const float light = linearFromSrgb(static_cast<float>(drawn.at(x, y).g) / 255), share = wanted.at(x, y);
                ASSERT_NEAR(light, share, 0.35) << name << " at " << x << ", " << y;
                missing += static_cast<double>(light - share);
                edge += share > 0 && share < 1 ? 1 : 0;
            }
        std::printf("%s: edges %.3f pixels off on average\n", name, missing / edge);
        EXPECT_LT(std::abs(missing / edge), 0.02) << name;
    }
}

glm::dvec2 centroid(const std::vector<glm::dvec2>& polygon) {
    glm::dvec2 sum(0);
    double area = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const glm::dvec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
        const double cross = a.x * b.y - b.x * a.y;
        sum += cross * (a + b);
        area += cross;
    }
    return sum / (3 * area);
}

// A small square that stands on a corner of what is shown: the quarter of it that is seen lies
// where the warp carries it.
TEST(Warped, corners_land_within_a_tenth_of_a_pixel) {
    constexpr double kEdge = 0.12, kAspect = 16.0 / 9;
    for (const auto& [name, shape] : warps()) {
        const Projection projection = projectionBy(shape);
        const CanvasPart& part = projection.warp.shape().part;
        for (const glm::dvec2 inwards : {glm::dvec2(1, 1), {-1, 1}, {-1, -1}, {1, -1}}) {
            const glm::dvec2 corner = glm::mix(part.low, part.high, (1.0 - inwards) / 2.0);
            std::vector<glm::dvec2> seen;  // round the quarter, in steps so small that a mesh's curves are followed
            for (int step = 0; step < 400; ++step) {
                const std::array<glm::dvec2, 5> round = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}}};
                const glm::dvec2 at = glm::mix(round[static_cast<std::size_t>(step / 100)],
                                               round[static_cast<std::size_t>(step / 100 + 1)], step % 100 / 100.0);
                seen.push_back(projection.warp.projectorFromCanvas(corner + at * inwards * kEdge / 2.0 / glm::dvec2(kAspect, 1)));
            }
            const glm::dvec2 onCanvas = corner * glm::dvec2(kAspect, 1);
            DrawnOutput output(projection, {resting(squareAt(onCanvas, kEdge / std::sqrt(2.0), glm::vec3(1)))});
            const RgbaImage& image = output.frame({{0, 1}});
            glm::dvec2 sum(0);
            double light = 0;
            for (int y = 0; y < kSize.y; ++y)
                for (int x = 0; x < kSize.x; ++x) {
                    const double here = static_cast<double>(linearFromSrgb(static_cast<float>(image.at(x, y).g) / 255));
                    sum += here * glm::dvec2(x + 0.5, y + 0.5);
                    light += here;
                }
            ASSERT_GT(light, 10) << name;
            EXPECT_LT(glm::distance(sum / light, centroid(seen)), 0.1) << name;
        }
    }
}

// A technician drags a corner while the show runs: what is drawn next is what a new renderer would
// draw.
TEST(Warped, a_renderer_follows_a_new_warp) {
    const FoliageSource foliage{
        glm::vec3(1), glm::vec3(0), {{moving(smallPattern()), {}}, {moving(smallPattern()), {0.1, nullptr}}}};
    const std::vector<PictureSource> sources = {moving(smallPattern()), SolidSource{{0.1f, 0, 0.2f}}, foliage};
    for (const auto& [from, to] : {std::pair<std::size_t, std::size_t>(1, 0), {0, 2}, {5, 4}}) {
        const Projection before = projectionBy(warps()[from].shape), after = projectionBy(warps()[to].shape);
        DrawnOutput edited(before, sources), made(after, sources);
        edited.frame({{0, 1}, {1, 1}, {2, 0.5f}});
        ASSERT_TRUE(edited.renderer().follow(after, nullptr));
        for (const std::uint32_t source : {0u, 1u})
            EXPECT_EQ(edited.frame({{source, 1}}), made.frame({{source, 1}})) << warps()[to].name << ", source " << source;
        // Its blurred pictures keep the size that they were made with, so the shadows' edges may be
        // a little softer.
        EXPECT_LE(difference(edited.frame({{2, 1}}), made.frame({{2, 1}})).rms, 6) << warps()[to].name;
    }
}

}  // namespace
}  // namespace fantascope::render
