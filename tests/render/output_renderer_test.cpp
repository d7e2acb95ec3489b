#include "render/output_renderer.h"

#include "render/reference_picture.h"
#include "render/scene.h"

#include "allocations.h"
#include "core/file.h"
#include "core/geometry.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <cmath>

namespace fantascope::render {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr glm::ivec2 kSize{320, 180};
constexpr double kAspect = 16.0 / 9;
// A colour is rounded twice, to an 8-bit square root and to an 8-bit sRGB value: the error is at
// most one stored value.
constexpr int kCoding = 1;

std::array<glm::dvec2, 4> upright(glm::ivec2 size) { return rectangleCorners(size.x, size.y); }

std::vector<pattern::InstancePose> restingPoses(const pattern::ShapePattern& pattern) {
    std::vector<pattern::InstancePose> poses;
    for (const pattern::ShapeInstance& instance : pattern.instances)
        poses.push_back({instance.centre, instance.size, instance.rotation});
    return poses;
}

// The centroid of a grey picture's light, in pixels.
glm::dvec2 centroidOfLight(const RgbaImage& image) {
    glm::dvec2 sum(0);
    double light = 0;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            const double here = linearFromSrgb(static_cast<float>(image.at(x, y).r) / 255);
            sum += here * glm::dvec2(x + 0.5, y + 0.5);
            light += here;
        }
    return sum / light;
}

glm::dvec2 centroid(const std::array<glm::dvec2, 4>& corners) {
    glm::dvec2 sum(0);
    double area = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const glm::dvec2 a = corners[i], b = corners[(i + 1) % 4];
        const double cross = a.x * b.y - b.x * a.y;
        sum += cross * (a + b);
        area += cross;
    }
    return sum / (3 * area);
}

// A solid fills exactly the quadrilateral that the technician has set.
// Example failure: the corners' order is taken for one with y up, as in OpenGL.
TEST(OutputRenderer, lights_the_warped_canvas_and_nothing_else) {
    const auto corners = keystone(kSize);
    DrawnOutput output(kSize, corners, {SolidSource{glm::vec3(0.5f, 1, 0)}});
    const RgbaImage& image = output.frame({{0, 1}});
    const auto canvasFromProjector = Homography::fromCorners(rectangleCorners(1, 1), corners)->inverse();
    for (int y = 0; y < kSize.y; ++y)
        for (int x = 0; x < kSize.x; ++x) {
            const glm::dvec2 canvas = canvasFromProjector({x + 0.5, y + 0.5});
            const double inside =
                std::min({canvas.x, canvas.y, 1 - canvas.x, 1 - canvas.y});  // in canvas units; a pixel is some 1/150
            if (std::abs(inside) < 0.01) continue;
            const Rgba8 pixel = image.at(x, y);
            ASSERT_NEAR(pixel.r, inside > 0 ? 188 : 0, kCoding) << x << ", " << y;
            ASSERT_EQ(pixel.g, inside > 0 ? 255 : 0) << x << ", " << y;
            ASSERT_EQ(pixel.b, 0) << x << ", " << y;
        }
    const glm::dvec2 found = centroidOfLight(image), wanted = centroid(corners);
    EXPECT_LT(glm::distance(found, wanted), 0.05);
}

// Of a square marker around a corner of the canvas, the quarter on the canvas is visible where the
// warp maps it. Example failure: half a pixel off, because pixel centres are taken for pixel
// corners.
TEST(OutputRenderer, carries_each_corner_of_the_canvas_to_the_asked_pixel) {
    const auto corners = keystone(kSize);
    const auto canvas = rectangleCorners(kAspect, 1);
    const Homography projectorFromCanvas = *Homography::fromCorners(canvas, corners);
    constexpr double kEdge = 0.16;  // of the marker, in canvas heights: the visible quarter is some 14 pixels wide
    for (std::size_t corner = 0; corner < 4; ++corner) {
        DrawnOutput output(kSize, corners, {resting(squareAt(canvas[corner], kEdge / std::sqrt(2.0), glm::vec3(1), kAspect))});
        const glm::dvec2 inwards = glm::sign(glm::dvec2(kAspect / 2, 0.5) - canvas[corner]) * kEdge / 2.0;
        std::array<glm::dvec2, 4> lit = {canvas[corner], canvas[corner] + glm::dvec2(inwards.x, 0), canvas[corner] + inwards,
                                         canvas[corner] + glm::dvec2(0, inwards.y)};
        for (glm::dvec2& point : lit) point = projectorFromCanvas(point);
        const glm::dvec2 found = centroidOfLight(output.frame({{0, 1}}));
        EXPECT_LT(glm::distance(found, centroid(lit)), 0.1) << "corner " << corner << ": " << found.x << ", " << found.y;
    }
}

// The light at a point of a picture, in pixels, interpolated between the four nearest pixels.
glm::dvec3 bilinear(const RgbaImage& picture, glm::dvec2 point) {
    const auto lightAt = [&](glm::ivec2 at) {
        at = glm::clamp(at, glm::ivec2(0), glm::ivec2(picture.width(), picture.height()) - 1);
        const Rgba8 stored = picture.at(at.x, at.y);
        const auto light = [](std::uint8_t value) {
            return static_cast<double>(linearFromSrgb(static_cast<float>(value) / 255));
        };
        return glm::dvec3(light(stored.r), light(stored.g), light(stored.b));
    };
    const glm::dvec2 corner = glm::floor(point - 0.5), part = point - 0.5 - corner;
    const glm::ivec2 at(corner);
    return glm::mix(glm::mix(lightAt(at), lightAt(at + glm::ivec2(1, 0)), part.x),
                    glm::mix(lightAt(at + glm::ivec2(0, 1)), lightAt(at + glm::ivec2(1, 1)), part.x), part.y);
}

// The reason for drawing shapes through the warp: warping a picture of the canvas blurs every edge.
// Both have the same numbers of pixels and samples.
TEST(OutputRenderer, is_nearer_to_the_truth_than_a_bent_picture_of_the_canvas) {
    constexpr glm::ivec2 kLarge{640, 360};
    const pattern::ShapePattern pattern = smallPattern();
    const auto corners = keystone(kLarge);
    const Homography projectorFromCanvas = *Homography::fromCorners(rectangleCorners(kAspect, 1), corners);
    const RgbaImage truth = referencePicture(pattern, restingPoses(pattern), Warp::of({.corners = corners}).value(), kLarge, 6);
    const double through = difference(DrawnOutput(kLarge, corners, {resting(pattern)}).frame({{0, 1}}), truth).rms;

    DrawnOutput flat(kLarge, upright(kLarge), {resting(pattern)});
    const RgbaImage& canvas = flat.frame({{0, 1}});
    const Homography canvasFromProjector = projectorFromCanvas.inverse();
    RgbaImage bent(kLarge.x, kLarge.y);
    for (int y = 0; y < kLarge.y; ++y)
        for (int x = 0; x < kLarge.x; ++x) {
            const glm::dvec2 point = canvasFromProjector(glm::dvec2(x, y) + 0.5);
            const bool on = point.x >= 0 && point.x <= kAspect && point.y >= 0 && point.y <= 1;
            const glm::dvec3 light = on ? bilinear(canvas, point * double(kLarge.y)) : glm::dvec3(0);
            const auto stored = [](double value) {
                return static_cast<std::uint8_t>(std::lround(255 * srgbFromLinear(static_cast<float>(value))));
            };
            bent.at(x, y) = {stored(light.r), stored(light.g), stored(light.b), 255};
        }
    const double bentApart = difference(bent, truth).rms;
    std::printf("through the warp rms %.2f of 255, canvas and bilinear %.2f\n", through, bentApart);
    EXPECT_LT(through, 0.8 * bentApart);
}

// Everything together: warp, order of instances, facets and their shading, edges, linear averaging,
// clipping at the canvas's edge. Four samples per pixel are inexact only at edges; inside a facet
// the colour is exact.
TEST(OutputRenderer, draws_what_a_point_by_point_reference_draws) {
    constexpr glm::ivec2 kLarge{640, 360};
    const pattern::ShapePattern pattern = smallPattern();
    const auto corners = keystone(kLarge);
    DrawnOutput output(kLarge, corners, {resting(pattern)});
    const RgbaImage& drawn = output.frame({{0, 1}});
    const RgbaImage reference =
        referencePicture(pattern, restingPoses(pattern), Warp::of({.corners = corners}).value(), kLarge, 6);
    const Difference apart = difference(drawn, reference);
    std::printf("rms %.2f of 255 against 36 points a pixel\n", apart.rms);
    RecordProperty("rms", std::to_string(apart.rms));
    EXPECT_LE(apart.rms, 4);

    int insideFacets = 0;
    for (int y = 1; y + 1 < kLarge.y; ++y)
        for (int x = 1; x + 1 < kLarge.x; ++x) {
            const Rgba8 wanted = reference.at(x, y), found = drawn.at(x, y);
            bool inside = wanted.r != 0;
            for (int i = 0; i < 9; ++i) inside = inside && reference.at(x - 1 + i % 3, y - 1 + i / 3) == wanted;
            if (!inside) continue;
            ++insideFacets;
            for (const int off : {found.r - wanted.r, found.g - wanted.g, found.b - wanted.b})
                ASSERT_LE(std::abs(off), kCoding) << "at " << x << ", " << y;
        }
    EXPECT_GT(insideFacets, 10'000);
}

// The same for a mirrored picture, as for rear projection.
// Example failure: front faces are taken for back faces and culled.
TEST(OutputRenderer, draws_the_mirror_image_through_mirrored_corners) {
    const pattern::ShapePattern pattern = smallPattern();
    const auto corners = upright(kSize);
    DrawnOutput seen(kSize, corners, {resting(pattern)});
    DrawnOutput mirrored(kSize, {corners[1], corners[0], corners[3], corners[2]}, {resting(pattern)});
    const RgbaImage& drawn = mirrored.frame({{0, 1}});
    RgbaImage turnedBack(kSize.x, kSize.y);
    for (int y = 0; y < kSize.y; ++y)
        for (int x = 0; x < kSize.x; ++x) turnedBack.at(x, y) = drawn.at(kSize.x - 1 - x, y);
    // The sample positions are not symmetric, so edges differ a little; missing front faces would
    // differ by far more.
    EXPECT_LE(difference(seen.frame({{0, 1}}), turnedBack).rms, 8);
}

TEST(OutputRenderer, adds_layers_as_linear_light) {
    DrawnOutput output({64, 36}, upright({64, 36}),
                       {SolidSource{glm::vec3(0.2f)}, SolidSource{glm::vec3(0.3f)}, SolidSource{glm::vec3(1)}});
    const auto grey = [&](const std::vector<show::LayerState>& layers) { return int{output.frame(layers).at(32, 18).g}; };
    EXPECT_NEAR(grey({{0, 1}, {1, 1}}), 188, 1);                 // 0.2 + 0.3 of the light; stored values would add to 123 + 149
    EXPECT_NEAR(grey({{0, 1}, {1, 0.5f}, {2, 0.15f}}), 188, 1);  // more layers than one pass takes
    EXPECT_NEAR(grey({{2, 0.5f}}), 188, 1);
    EXPECT_NEAR(grey({{2, 0.25f}, {2, 0.25f}}), 188, 1);
    EXPECT_EQ(grey({{2, 1}, {0, 1}}), 255);
    EXPECT_EQ(grey({{2, 0}}), 0);
}

// Example failure: the factors are upside down, or dim the black that the blend adds.
TEST(OutputRenderer, dims_by_the_light_correction_as_far_as_it_is_faded_in) {
    auto gain = std::make_shared<GreyImage>(kSize.x, kSize.y);
    for (int y = 0; y < kSize.y; ++y)
        for (int x = 0; x < kSize.x; ++x)
            gain->at(x, y) = 0.3f + 0.35f * static_cast<float>(x) / kSize.x + 0.35f * static_cast<float>(y) / kSize.y;
    auto blend = std::make_shared<BlendMap>(kSize.x, kSize.y, glm::vec2(0.8f, 0.05f));
    const Projection projection = projectionTo(kSize, upright(kSize));
    const std::vector<PictureSource> white = {SolidSource{glm::vec3(1)}};
    DrawnOutput plain(projection, white), corrected(projection, white, nullptr, "headless", gain),
        blended(projection, white, blend, "headless", gain);
    for (const float share : {0.0f, 0.4f, 1.0f}) {
        corrected.renderer().correctLight(share);
        blended.renderer().correctLight(share);
        const RgbaImage alone = corrected.frame({{0, 1}}), beside = blended.frame({{0, 1}});
        if (share == 0) {
            EXPECT_EQ(alone, plain.frame({{0, 1}}));
        }
        for (int y = 0; y < kSize.y; y += 7)
            for (int x = 0; x < kSize.x; x += 7) {
                const float factor = 1 - share * (1 - gain->at(x, y));
                ASSERT_NEAR(alone.at(x, y).g, 255 * srgbFromLinear(factor), 1) << x << ", " << y << ", " << share;
                ASSERT_NEAR(beside.at(x, y).g, 255 * srgbFromLinear(factor * 0.8f + 0.05f), 1) << x << ", " << y << ", " << share;
            }
    }
    const RgbaImage card(kSize.x, kSize.y, Rgba8{255, 255, 255, 255});
    ASSERT_TRUE(corrected.sink().makeCurrent());
    ASSERT_TRUE(corrected.renderer().setUp(nullptr, &card));
    EXPECT_EQ(corrected.frame({{0, 1}}).at(0, 0).g, 255) << "a card is for judging the projector itself";
}

// Blend and light correction belong to places on the wall. Example failures: they move the other
// way, or upside down; they stay moved.
TEST(OutputRenderer, moves_its_maps_with_a_shifted_picture) {
    auto gain = std::make_shared<GreyImage>(kSize.x, kSize.y);
    auto blend = std::make_shared<BlendMap>(kSize.x, kSize.y);
    const auto gainAt = [](glm::dvec2 at) { return 0.3 + 0.35 * at.x / kSize.x + 0.35 * at.y / kSize.y; };
    const auto blendAt = [](glm::dvec2 at) { return 0.9 - 0.4 * at.x / kSize.x + 0.1 * at.y / kSize.y; };
    for (int y = 0; y < kSize.y; ++y)
        for (int x = 0; x < kSize.x; ++x) {
            gain->at(x, y) = static_cast<float>(gainAt({x + 0.5, y + 0.5}));
            blend->at(x, y) = {static_cast<float>(blendAt({x + 0.5, y + 0.5})), 0.02f};
        }
    DrawnOutput output(projectionTo(kSize, upright(kSize)), {SolidSource{glm::vec3(1)}}, blend, "headless", gain);
    const RgbaImage before = output.frame({{0, 1}});
    const Homography moved =
        *Homography::fromCorners(rectangleCorners(kSize.x, kSize.y),
                                 {glm::dvec2(9, -6), {kSize.x + 12, 4}, {kSize.x - 7, kSize.y + 8}, {-5, kSize.y - 3}});
    output.renderer().moveMaps(moved);
    const RgbaImage after = output.frame({{0, 1}});
    for (int y = 20; y < kSize.y - 20; y += 7)
        for (int x = 20; x < kSize.x - 20; x += 7) {
            const glm::dvec2 from = moved.inverse()({x + 0.5, y + 0.5});
            ASSERT_NEAR(after.at(x, y).g, 255 * srgbFromLinear(static_cast<float>(gainAt(from) * blendAt(from) + 0.02)), 1)
                << x << ", " << y;
        }
    output.renderer().moveMaps(std::nullopt);
    EXPECT_EQ(output.frame({{0, 1}}), before);
}

// Example failure: the last frame's picture stays when all layers have gone.
TEST(OutputRenderer, is_black_without_layers) {
    DrawnOutput output({64, 36}, upright({64, 36}), {SolidSource{}});
    ASSERT_EQ(output.frame({{0, 1}}).at(5, 5), (Rgba8{255, 255, 255, 255}));
    for (const Rgba8 pixel : output.frame(std::vector<show::LayerState>{}).pixels()) ASSERT_EQ(pixel, (Rgba8{0, 0, 0, 255}));
}

// Two overlapping squares in a layer that fades over another layer: neither is visible through the
// other.
TEST(OutputRenderer, fades_a_pattern_as_one_picture) {
    pattern::ShapePattern pattern = squareAt({0.8, 0.5}, 0.3, glm::vec3(1));
    pattern.instances.push_back(pattern.instances[0]);
    pattern.instances[1].centre.x = 1.0;
    DrawnOutput output(kSize, upright(kSize), {SolidSource{glm::vec3(0.25f)}, resting(pattern)});
    const RgbaImage& image = output.frame({{0, 1}, {1, 0.25f}});
    const auto greyAt = [&](double x, double y) { return int{image.at(static_cast<int>(x * 180), static_cast<int>(y * 180)).r}; };
    EXPECT_NEAR(greyAt(0.65, 0.5), 188, 1) << "one square: 0.25 + 0.25 of the light";
    EXPECT_NEAR(greyAt(0.9, 0.5), 188, 1) << "both squares";
    EXPECT_NEAR(greyAt(0.2, 0.2), 137, 1) << "no square";
}

// Whatever their tilt, a later instance entirely covers an earlier one, and instances never
// intersect.
TEST(OutputRenderer, puts_the_later_instance_on_top) {
    pattern::ShapePattern pattern = squareAt({0.8, 0.5}, 0.3, glm::vec3(1, 0, 0));
    pattern.instances.push_back(pattern.instances[0]);
    pattern.instances[0].rotation.y = 1;  // its right half moves towards the viewer
    pattern.instances[1].rotation.y = -1;
    pattern.instances[1].colour = {0, 1, 0};
    const auto drawn = [&] { return DrawnOutput(kSize, keystone(kSize), {resting(pattern)}).frame({{0, 1}}); };
    const auto has = [](const RgbaImage& image, Rgba8 colour) { return std::ranges::count(image.pixels(), colour) > 0; };
    EXPECT_FALSE(has(drawn(), {255, 0, 0, 255}));
    std::swap(pattern.instances[0], pattern.instances[1]);
    EXPECT_FALSE(has(drawn(), {0, 255, 0, 255}));
}

// Shapes far outside the canvas, even behind the horizon of a steep warp, leave no trace.
TEST(OutputRenderer, cuts_shapes_at_the_canvas_and_never_lights_beyond_it) {
    const std::array<glm::dvec2, 4> steep = {{{150, 20}, {170, 20}, {300, 160}, {20, 160}}};
    const Homography projectorFromCanvas = *Homography::fromCorners(rectangleCorners(kAspect, 1), steep);
    // The canvas y at which w is 0: a little below the canvas, where the picture is wide.
    const double horizon = -projectorFromCanvas.matrix()[2].z / projectorFromCanvas.matrix()[1].z;
    ASSERT_GT(horizon, 1.06);
    pattern::ShapePattern pattern = squareAt({0.8, horizon}, 0.06, glm::vec3(1));
    pattern.instances.push_back(pattern.instances[0]);
    pattern.instances[1].centre = {0.8, horizon + 1};
    pattern.instances.push_back(pattern.instances[0]);
    pattern.instances[2].centre = {-0.3, 0.5};
    const auto drawn = [&](const PictureSource& source) -> RgbaImage {
        return DrawnOutput(kSize, steep, {source}).frame({{0, 1}});
    };
    const RgbaImage none = drawn(resting(pattern));
    for (const Rgba8 pixel : none.pixels()) ASSERT_EQ(pixel, (Rgba8{0, 0, 0, 255}));
    // A shape that extends from behind the horizon over the whole canvas lights all of it.
    pattern.instances = {pattern.instances[0]};
    pattern.instances[0].size = 20;
    EXPECT_LE(difference(drawn(resting(pattern)), drawn(SolidSource{})).most, 1);
}

// The picture depends on show time alone: forwards, backwards, and over the end of the loop.
TEST(OutputRenderer, shows_the_pattern_as_it_stands_at_the_show_time) {
    const PatternSource source = moving(smallPattern());
    DrawnOutput output(kSize, keystone(kSize), {source});
    const RgbaImage at1 = output.frame({{0, 1}}, std::chrono::seconds(1));
    const RgbaImage at9 = output.frame({{0, 1}}, std::chrono::seconds(9));
    EXPECT_GT(difference(at1, at9).rms, 5);
    EXPECT_EQ(output.frame({{0, 1}}, std::chrono::seconds(1)), at1);
    EXPECT_EQ(output.frame({{0, 1}}, source.motion->period() + std::chrono::seconds(9)), at9);
}

TEST(OutputRenderer, shows_the_pattern_in_the_wind_that_it_is_given) {
    const PatternSource source = moving(smallPattern());
    DrawnOutput output(kSize, keystone(kSize), {source, PatternSource{source.pattern, nullptr}});
    const show::OutputState layers{{{0, 1}}};
    const RgbaImage usual = output.frame(layers, std::chrono::seconds(1)),
                    strong = output.frame(layers, std::chrono::seconds(1), {.strength = 3}),
                    none = output.frame(layers, std::chrono::seconds(1), {.strength = 0});
    EXPECT_GT(difference(usual, strong).rms, 5);
    EXPECT_EQ(none, output.frame({{1, 1}}));
}

TEST(OutputRenderer, allocates_nothing_once_it_runs) {
    DrawnOutput output(kSize, keystone(kSize), {moving(smallPattern()), moving(smallPattern()), SolidSource{}});
    FrameReader& reader = output.tap().addQueue();
    ASSERT_TRUE(output.tap().prepare());
    const show::OutputState look{{{0, 0.5f}, {1, 0.5f}, {2, 0.1f}}};
    for (int frame = 0; frame < 3; ++frame) output.frame(look, tickTime(frame, 30));
    int read = 0;
    const std::int64_t before = allocationsSoFar();
    for (int frame = 3; frame < 20; ++frame) {
        output.frame(look, tickTime(frame, 30));
        while (reader.next(Time::max()) != nullptr) ++read;
    }
    EXPECT_EQ(allocationsSoFar() - before, 0);
    EXPECT_EQ(read, 20);
}

TEST(OutputRenderer, leaves_no_opengl_error_and_refuses_what_cannot_be_drawn) {
    DrawnOutput output({64, 36}, upright({64, 36}), {});
    const auto refusal = [&](const OutputRenderer::Options& options) {
        const auto sources = PictureSources::numbered({SolidSource{}});
        const auto renderer = OutputRenderer::create(options, sources);
        return renderer ? "accepted" : renderer.error().message();
    };
    OutputRenderer::Options options{projectionTo({64, 36}, upright({64, 36})), {}, 4, shaderFolder()};
    EXPECT_EQ(refusal(options), "accepted");
    options.samples = 1000;
    EXPECT_THAT(refusal(options), HasSubstr("1000 samples per pixel: OpenGL has 1 .. "));
    options.samples = 4;
    options.projection.size.x = 1'000'000;
    EXPECT_THAT(refusal(options), HasSubstr("1000000 x 36 pixels"));
}

// Somebody who edits a shader gets the compiler's message with the file's name.
TEST(OutputRenderer, names_the_shader_that_does_not_compile) {
    DrawnOutput output({64, 36}, upright({64, 36}), {});
    const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "broken_shaders";
    std::filesystem::copy(shaderFolder(), folder,
                          std::filesystem::copy_options::recursive | std::filesystem::copy_options::overwrite_existing);
    const auto refusal = [&] {
        const auto renderer = OutputRenderer::create({projectionTo({64, 36}, upright({64, 36})), {}, 4, folder}, {});
        return renderer ? "accepted" : renderer.error().message();
    };
    std::string text = readFile(folder / "shape.frag").value();
    const std::string_view assigned = "root = vec4(";
    text.replace(text.find(assigned), assigned.size(), "colour = vec4(");
    ASSERT_TRUE(writeFile(folder / "shape.frag", text));
    EXPECT_THAT(refusal(), AllOf(HasSubstr("broken_shaders/shape.frag: the shader does not compile"), HasSubstr("colour")));
    std::filesystem::remove(folder / "shape.frag");
    EXPECT_THAT(refusal(), HasSubstr("broken_shaders/shape.frag"));
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace fantascope::render
