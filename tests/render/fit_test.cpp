// Sources with another aspect than the canvas: round things must stay round, measured in the drawn
// picture.

#include "core/fit.h"

#include "render/output_renderer.h"
#include "render/scene.h"
#include "theatre/a_scene.h"
#include "theatre/stage/cast.h"

#include "core/geometry.h"
#include "scratch_folder.h"
#include "test_video.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace fantascope::render {
namespace {

constexpr glm::ivec2 kSize{640, 360};
constexpr double kCanvas = 16.0 / 9;
constexpr int kPicture = 240;     // pixels, each way
constexpr double kRadius = 0.25;  // of the disc, in heights of its square picture

template <class T>
T valueOf(Result<T> result) {
    FANTASCOPE_CHECK(result.has_value(), result.error().message());
    return std::move(result).value();
}

Projection straight(glm::ivec2 size, double canvasAspect) {
    Projection projection = projectionTo(size, rectangleCorners(size.x, size.y));
    projection.canvasAspect = canvasAspect;
    return projection;
}

// ---- A disc in the middle of a square, by every source kind that can show one

RgbaImage discPicture() {
    RgbaImage picture(kPicture, kPicture);
    for (int y = 0; y < kPicture; ++y)
        for (int x = 0; x < kPicture; ++x) {
            const bool isIn = glm::distance(glm::dvec2(x, y) + 0.5, glm::dvec2(kPicture / 2.0)) < kRadius * kPicture;
            picture.at(x, y) = isIn ? Rgba8{255, 255, 255, 255} : Rgba8{0, 0, 0, 255};
        }
    return picture;
}

pattern::ShapePattern discPattern() {
    pattern::ShapePattern pattern = squareAt({0.5, 0.5}, kRadius, glm::vec3(1), 1);
    constexpr int kSides = 96;
    TriangleMesh disc{{{0, 0, 0}}, {}};
    for (int i = 0; i < kSides; ++i) {
        const double angle = 2 * std::numbers::pi * i / kSides;
        disc.vertices.emplace_back(std::cos(angle), std::sin(angle), 0);
        disc.triangles.emplace_back(0, 1 + i, 1 + (i + 1) % kSides);
    }
    pattern.shapes[0].mesh = std::move(disc);
    return pattern;
}

struct Kind {
    const char* name;
    std::function<PictureSource()> make;
};

// A disc of light is measured by what it lights, a square shadow by what it darkens.
class Fitting : public testing::Test {
protected:
    std::vector<Kind> kinds() {
        return {{"pattern", [] { return PictureSource(resting(discPattern())); }},
                {"foliage",
                 [] {
                     FoliageSource foliage;
                     foliage.layers.push_back({resting(discPattern()), {0, nullptr}, true});
                     return PictureSource(foliage);
                 }},
                {"image", [] { return PictureSource(ImageSource{std::make_shared<const RgbaImage>(discPicture())}); }},
                {"video",
                 [this] {
                     const auto file = folder_ / "disc.mp4";
                     writeVideo(file, {.size = {kPicture, kPicture}}, 3, [](int) { return discPicture(); });
                     return PictureSource(
                         VideoSource{.stream = valueOf(VideoStream::open(file, VideoStream::Pace::Exact))});
                 }},
                {"camera",
                 [] {
                     const auto feed = std::make_shared<PictureFeed>(glm::ivec2(kPicture));
                     return PictureSource(CameraSource{feed});
                 }},
                {"shadow", [] { return PictureSource(plate()); }}};
    }

    // A square in front of a screen whose shadow is half as high as the picture. The actor is far
    // out of sight.
    static ShadowSource plate() {
        theatre::Cast cast;
        cast.stage.beams[0].light = {0, 1, 8};
        cast.stage.props.push_back(theatre::aBox({0.5, 0.5, 0.002}, {0, 1, 4}));
        theatre::PoseProblem problem{cast.stage, {theatre::aScene({}).targets[0]}, {theatre::humanBody(1.7)}, {}};
        const std::vector<double> pose = problem.actors[0].restPose({60, 1, 4}, {1, 0, 0, 0});
        cast.actors.push_back({1.7, {theatre::poseOf(problem.actors[0], pose)}});
        ShadowSource shadow;
        shadow.cast = std::make_shared<const theatre::Cast>(std::move(cast));
        shadow.lamps = {{{0, 1, 8}, 0, glm::vec3(1), glm::vec3(0), {}}};
        shadow.from = {-1, 0};
        shadow.to = {1, 2};
        return shadow;
    }

    static PictureSource fitted(PictureSource source, Fit fit) {
        source.fit = fit;
        return source;
    }
    static RgbaImage drawn(const Projection& projection, const PictureSource& source) {
        DrawnOutput output(projection, {source});
        const show::OutputState state{{{0, 1.0f}}};
        if (const auto* camera = std::get_if<CameraSource>(&source.picture))
            camera->feed->publish(std::make_shared<const RgbaImage>(discPicture()));
        return output.frame(state);
    }

    const ScratchFolder folder_;
};

// The centroid and the spread of the light, or of a shadow within its light, in pixels.
struct Moments {
    glm::dvec2 middle{0}, spread{0};
};

Moments momentsOf(const RgbaImage& image, bool ofShadow) {
    double sum = 0;
    glm::dvec2 first(0), second(0);
    glm::ivec2 low = {image.width(), image.height()}, high(-1);
    const auto light = [&](int x, int y) { return linearFromSrgb(static_cast<float>(image.at(x, y).g) / 255); };
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x)
            if (light(x, y) > 0.5f) low = glm::min(low, glm::ivec2(x, y)), high = glm::max(high, glm::ivec2(x, y));
    for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) {
            const double weight = ofShadow ? 1 - light(x, y) : light(x, y);
            const glm::dvec2 at(x + 0.5, y + 0.5);
            sum += weight, first += weight * at, second += weight * at * at;
        }
    const glm::dvec2 middle = first / sum;
    return {middle, glm::sqrt(second / sum - middle * middle)};
}

// Example failures: a circle drawn on a square becomes an ellipse 1.8 times as wide as high; one
// kind of source is forgotten.
TEST_F(Fitting, what_is_round_on_a_square_is_round_on_a_wide_canvas_but_where_it_is_stretched) {
    for (const Kind& kind : kinds()) {
        const bool isShadow = kind.name == std::string("shadow");
        const PictureSource source = kind.make();
        // The standard deviation of a square and of a disc of width 1 along one axis.
        const double spread = isShadow ? 1 / std::sqrt(12.0) : 0.25;
        const struct {
            Fit fit;
            glm::dvec2 size;  // of the picture on the output, pixels
        } cases[] = {{Fit::Contain, {kSize.y, kSize.y}}, {Fit::Cover, {kSize.x, kSize.x}}, {Fit::Stretch, kSize}};
        for (const auto& [fit, size] : cases) {
            const Moments seen = momentsOf(drawn(straight(kSize, kCanvas), fitted(source, fit)), isShadow);
            const glm::dvec2 expected = 2 * kRadius * spread * size;
            EXPECT_NEAR(seen.spread.x / expected.x, 1, 0.01) << kind.name << ", fit " << static_cast<int>(fit);
            EXPECT_NEAR(seen.spread.y / expected.y, 1, 0.01) << kind.name << ", fit " << static_cast<int>(fit);
            EXPECT_NEAR(seen.middle.x, kSize.x / 2.0, 0.5) << kind.name;
            EXPECT_NEAR(seen.middle.y, kSize.y / 2.0, 0.5) << kind.name;
        }
    }
}

// The canvas's aspect counts, not the output's: for projectors that share a canvas, that lie on
// their side, or that have a keystone.
TEST_F(Fitting, goes_by_the_canvas_whatever_part_an_output_shows_of_it) {
    WarpShape half{.corners = rectangleCorners(kSize.x, kSize.y)};
    half.part = {{0.25, 0}, {0.75, 1}};  // of a canvas twice as wide as the output
    Projection projection = straight(kSize, 2 * kCanvas);
    projection.warp = Warp::of(half).value();
    WarpShape onItsSide{.corners = rectangleCorners(kSize.y, kSize.x)};
    onItsSide.orientation.quarterTurns = 1;
    Projection turned = straight({kSize.y, kSize.x}, kCanvas);
    turned.warp = Warp::of(onItsSide).value();
    for (const Kind& kind : kinds()) {
        const bool isShadow = kind.name == std::string("shadow");
        const PictureSource source = kind.make();
        for (const Projection& each : {projection, turned}) {
            const Moments seen = momentsOf(drawn(each, source), isShadow);
            EXPECT_NEAR(seen.spread.x / seen.spread.y, 1, 0.01) << kind.name;
            EXPECT_NEAR(seen.middle.x, each.size.x / 2.0, 0.5) << kind.name;
        }
    }
}

// If a technician moves the corners, the canvas gets another aspect and every source another place
// on it.
TEST_F(Fitting, follows_the_canvass_shape) {
    const Projection wide = straight(kSize, kCanvas), wider = straight(kSize, 2 * kCanvas);
    for (const Kind& kind : kinds()) {
        const PictureSource source = kind.make();
        DrawnOutput output(wide, {source});
        if (const auto* camera = std::get_if<CameraSource>(&source.picture))
            camera->feed->publish(std::make_shared<const RgbaImage>(discPicture()));
        const show::OutputState state{{{0, 1.0f}}};
        (void)output.frame(state);
        ASSERT_TRUE(output.renderer().follow(wider, nullptr));
        const Moments seen = momentsOf(output.frame(state), kind.name == std::string("shadow"));
        EXPECT_NEAR(seen.spread.x / seen.spread.y, 0.5, 0.01)
            << kind.name;  // in pixels of an output that is stretched on the wall
    }
}

// Example failure: leaves that sway over the drawing's edge are visible in the dark beside it.
TEST_F(Fitting, nothing_is_seen_beside_a_contained_picture) {
    const glm::ivec2 beside{(kSize.x - kSize.y) / 2, 0};
    FoliageSource lit;
    lit.layers.push_back({resting(discPattern()), {0, nullptr}, false});
    CausticsSource caustics;
    caustics.size = {2, 2}, caustics.depth = 0.6, caustics.waveLength = 0.5, caustics.waveHeight = 0.01;
    const std::vector<PictureSource> sources = {
        resting(squareAt({0.5, 0.5}, 3, glm::vec3(1), 1)), lit, caustics,
        ImageSource{std::make_shared<const RgbaImage>(RgbaImage(8, 8, Rgba8{255, 255, 255, 255}))}, plate()};
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const RgbaImage image = drawn(straight(kSize, kCanvas), sources[i]);
        int dark = 0, light = 0;
        for (int y = 0; y < kSize.y; ++y)
            for (const int x : {0, beside.x - 2, kSize.x - beside.x + 1, kSize.x - 1}) dark += image.at(x, y).g == 0;
        for (int x = beside.x + 2; x < kSize.x - beside.x - 2; ++x) light += image.at(x, 2).g > 0;
        EXPECT_EQ(dark, 4 * kSize.y) << i;
        EXPECT_EQ(light, kSize.y - 4) << i;
    }
}

// Example failure: all existing shows look slightly different.
TEST_F(Fitting, a_picture_of_the_canvass_own_shape_is_drawn_as_it_ever_was) {
    Projection bent = projectionTo(kSize, keystone(kSize));
    const std::vector<PictureSource> sources = {moving(smallPattern()),
                                                ImageSource{std::make_shared<const RgbaImage>(64, 36, Rgba8{200, 100, 50, 255})}};
    for (const PictureSource& source : sources) {
        bent.canvasAspect = 0;
        const RgbaImage before = drawn(bent, source);
        bent.canvasAspect = 1.01 * kCanvas;  // as if somebody had measured the canvas
        for (const Fit fit : {Fit::Contain, Fit::Cover, Fit::Stretch}) EXPECT_EQ(drawn(bent, fitted(source, fit)), before);
    }
}

TEST(PlaceOnCanvas, is_in_the_middle_and_keeps_the_pictures_shape) {
    const CanvasPart narrow = placeOnCanvas(1, 2, Fit::Contain), wide = placeOnCanvas(4, 2, Fit::Contain);
    EXPECT_EQ(narrow, (CanvasPart{{0.25, 0}, {0.75, 1}}));
    EXPECT_EQ(wide, (CanvasPart{{0, 0.25}, {1, 0.75}}));
    EXPECT_EQ(placeOnCanvas(1, 2, Fit::Cover), (CanvasPart{{0, -0.5}, {1, 1.5}}));
    EXPECT_EQ(placeOnCanvas(1, 2, Fit::Stretch), CanvasPart());
    EXPECT_EQ(placeOnCanvas(2.03, 2, Fit::Contain), CanvasPart()) << "visibly the same aspect";
}

TEST(Warp, of_a_picture_on_a_canvas_throws_its_points_where_the_canvass_are) {
    WarpShape shape{.corners = keystone(kSize)};
    shape.part = {{0.1, 0}, {0.8, 0.9}};
    shape.orientation.flip = Orientation::Flip::Horizontal;
    const Warp canvas = Warp::of(shape).value();
    const CanvasPart place{{0.25, -0.5}, {0.75, 1.5}};
    const Warp picture = canvas.ofPictureOn(place);
    for (const glm::dvec2 point : {glm::dvec2(0.2, 0.3), glm::dvec2(0.9, 0.6), glm::dvec2(0.5, 0.5)}) {
        const glm::dvec2 there = canvas.projectorFromCanvas(place.low + point * (place.high - place.low));
        EXPECT_LT(glm::distance(picture.projectorFromCanvas(point), there), 1e-9);
    }
    EXPECT_LT(glm::distance(picture.shown().low, glm::dvec2(0, 0.25)), 1e-12);
    EXPECT_LT(glm::distance(picture.shown().high, glm::dvec2(1, 0.7)), 1e-12);
}

}  // namespace
}  // namespace fantascope::render
