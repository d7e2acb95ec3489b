// Synthetic photographs of a wall, made without the simulated site: pixel by pixel through the
// nominal geometry.

#include "vision/compare/guide_comparison.h"

#include "core/random.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

namespace fantascope::vision {
namespace {

constexpr double kAspect = 16.0 / 9;

// A projector that faces a wall from the side, with a rectified picture, and a camera with slight
// barrel distortion.
NominalView nominalView() {
    const Pose eye = Pose::lookingAt({0.3, 1.6, 5}, {0, 1.2, 0}).value(),
               lamp = Pose::lookingAt({1.6, 2, 4}, {0, 1.2, 0}).value();
    NominalView view;
    view.camera = CameraModel::fromFieldOfView(eye, {320, 180}, 0.9, -0.08).value();
    view.projector = CameraModel::fromThrowRatio(lamp, {640, 360}, 1.1, {0, 0});
    view.canvasAspect = kAspect;
    const auto corners =
        rectifyingCorners(view.projector, {{{-1.2, 1.875, 0}, {1.2, 1.875, 0}, {1.2, 0.525, 0}, {-1.2, 0.525, 0}}});
    view.warp = Warp::of({.corners = corners.value()}).value();
    return view;
}

// A spiral of light: different at every other place and orientation.
GreyImage spiral() {
    GreyImage guide(320, 180);
    for (int y = 0; y < 180; ++y)
        for (int x = 0; x < 320; ++x) {
            const glm::dvec2 at = glm::dvec2(x + 0.5, y + 0.5) / 180.0 - glm::dvec2(0.8, 0.5);
            const double turns = glm::length(at) / 0.13 - std::atan2(at.y, at.x) / (2 * std::numbers::pi);
            const double fromLine = std::abs(turns - std::round(turns));
            if (glm::length(at) < 0.48) guide.at(x, y) = static_cast<float>(0.9 * std::exp(-fromLine * fromLine * 40));
        }
    return guide;
}

struct Photograph {
    glm::dvec3 scale{0.6};          // linear light of a white picture
    glm::dvec3 ambient{0.02};       // linear light of the wall without it
    glm::dvec3 ambientAcross{0.0};  // added to ambient from the left to the right end of the visible wall
    double noise = 0;               // of the linear light
    double turned = 0;              // degrees by which the projector is turned to the side
};

// The light of a projector pixel per square metre of the wall: its pixels there, relative to the
// picture's centre.
double falloff(const CameraModel& projector, glm::dvec3 point) {
    const auto pixelsPerArea = [&](glm::dvec3 at) {
        const glm::dvec3 toLens = projector.pose.position - at;
        return toLens.z / std::pow(glm::dot(-toLens, projector.pose.worldFromLocal[2]), 3);
    };
    return pixelsPerArea(point) / pixelsPerArea({0, 1.2, 0});
}

RgbaImage photographed(const GreyImage& picture, const Photograph& how) {
    const NominalView view = nominalView();
    CameraModel projector = view.projector;
    projector.pose.worldFromLocal = projector.pose.worldFromLocal * rotationXyz({0, how.turned * std::numbers::pi / 180, 0});
    RgbaImage frame(view.camera.size.x, view.camera.size.y);
    Rng rng(3);
    constexpr int kSide = 3;
    for (int y = 0; y < frame.height(); ++y)
        for (int x = 0; x < frame.width(); ++x) {
            glm::dvec3 light(0.0);
            for (int i = 0; i < kSide * kSide; ++i) {
                const glm::dvec2 pixel(x + (i % kSide + 0.5) / kSide, y + (i / kSide + 0.5) / kSide);
                const glm::dvec3 point = view.surface.hitBy(view.camera.rayThrough(pixel)).value();
                const glm::dvec2 canvas =
                    view.warp.canvasFromProjector(projector.pixelFromWorld(point).value()).value() * glm::dvec2(kAspect, 1);
                light += how.ambient + how.ambientAcross * (0.5 + point.x / 4);
                if (canvas.x < 0 || canvas.y < 0 || canvas.x >= kAspect || canvas.y >= 1) continue;
                const float shown = picture.at(static_cast<int>(canvas.x * 180), static_cast<int>(canvas.y * 180));
                light += how.scale * (shown * falloff(projector, point));
            }
            const auto stored = [&](double linear) {
                const double noisy = linear / (kSide * kSide) + how.noise * rng.normal();
                return static_cast<std::uint8_t>(
                    std::lround(255 * srgbFromLinear(static_cast<float>(std::clamp(noisy, 0.0, 1.0)))));
            };
            frame.at(x, y) = {stored(light.r), stored(light.g), stored(light.b), 255};
        }
    return frame;
}

double score(const GreyImage& guide, const RgbaImage& frame) {
    return GuideComparison(nominalView(), guide, guide).compare(frame).value_or(Likeness{NAN, NAN}).z;
}

TEST(GuideComparison, is_near_zero_for_the_guide_itself_and_far_from_it_for_other_pictures) {
    const GreyImage guide = spiral();
    GreyImage mirrored = guide;
    for (int y = 0; y < 180; ++y) std::reverse(mirrored.row(y).begin(), mirrored.row(y).end());
    const double right = score(guide, photographed(guide, {}));
    EXPECT_LT(right, 0.015);
    // An inverted picture equals the original with a negative exposure, which no camera has.
    EXPECT_GT(score(guide, photographed(inverted(guide), {})), 0.15);
    EXPECT_GT(score(guide, photographed(mirrored, {})), 0.1);
}

TEST(GuideComparison, grows_with_the_way_that_the_picture_has_moved) {
    const GreyImage guide = spiral();
    double last = score(guide, photographed(guide, {}));
    for (const double degrees : {0.25, 0.5, 1.0, 1.5}) {
        const double moved = score(guide, photographed(guide, {.turned = degrees}));
        EXPECT_GT(moved, 1.15 * last) << degrees;
        last = moved;
    }
}

TEST(GuideComparison, does_not_mind_exposure_fades_colours_ambient_light_and_noise) {
    const GreyImage guide = spiral();
    const double plain = score(guide, photographed(guide, {}));
    const std::vector<std::pair<std::string, Photograph>> ways = {
        {"a fade", {.scale = glm::dvec3(0.08)}},
        {"blue shapes", {.scale = {0.05, 0.1, 0.5}}},
        {"light of the sky", {.ambient = {0.1, 0.12, 0.2}}},
        {"a warm lamp from the side", {.ambientAcross = {0.3, 0.15, 0.05}}},
        {"a warm lamp on blue shapes", {.scale = {0.05, 0.1, 0.5}, .ambientAcross = {0.3, 0.15, 0.05}}},
        {"noise", {.noise = 0.03}},
    };
    for (const auto& [what, how] : ways) EXPECT_NEAR(score(guide, photographed(guide, how)), plain, 0.006) << what;
}

// A guide as smooth as ambient light must not be taken for it.
TEST(GuideComparison, keeps_a_guide_that_is_a_mere_gradient) {
    GreyImage ramp(320, 180), back(320, 180);
    for (int y = 0; y < 180; ++y)
        for (int x = 0; x < 320; ++x) {
            ramp.at(x, y) = static_cast<float>(x) / 320;
            back.at(x, y) = 1 - ramp.at(x, y);
        }
    EXPECT_LT(score(ramp, photographed(ramp, {})), 0.02);
    EXPECT_GT(score(ramp, photographed(back, {})), 0.3);
}

TEST(GuideComparison, has_no_value_where_there_is_nothing_to_compare) {
    const GuideComparison comparison(nominalView(), spiral(), spiral());
    const GreyImage black(320, 180);
    EXPECT_FALSE(comparison.compare(photographed(black, {.ambient = glm::dvec3(0), .noise = 0.01}))) << "the dark";
    EXPECT_FALSE(
        comparison.compare(photographed(black, {.ambient = {0.3, 0.2, 0.1}, .ambientAcross = {0.3, 0.2, 0.1}, .noise = 0.02})))
        << "lamps on an empty wall";

    NominalView turnedAway = nominalView();
    turnedAway.camera.pose = Pose::lookingAt({0.3, 1.6, 5}, {0.3, 1.6, 9}).value();
    EXPECT_FALSE(GuideComparison(turnedAway, spiral(), spiral()).compare(photographed(spiral(), {})))
        << "a camera that looks elsewhere";
    EXPECT_FALSE(GuideComparison(nominalView(), black, black).compare(photographed(spiral(), {}))) << "a guide without a drawing";
}

// The tone takes the light as it is. Example failure: the projector's fall-off, or what the guide
// stores instead of light, is taken for what was wanted.
TEST(GuideComparison, its_tone_is_that_of_the_light_as_it_is) {
    const GreyImage guide = spiral();
    GreyImage stored = guide, corrected = guide;
    for (float& value : stored.pixels()) value = srgbFromLinear(value);
    const NominalView view = nominalView();
    for (int y = 0; y < 180; ++y)
        for (int x = 0; x < 320; ++x) {
            const auto point = view.surface.hitBy(
                view.projector.rayThrough(view.warp.projectorFromCanvas((glm::dvec2(x, y) + 0.5) / glm::dvec2(320, 180))));
            corrected.at(x, y) *= static_cast<float>(0.5 / falloff(view.projector, *point));
        }
    const GuideComparison comparison(view, stored, guide);
    NominalView evened = view;
    evened.isEvenedOut = true;
    const auto plain = *comparison.compare(photographed(guide, {})), level = *comparison.compare(photographed(corrected, {}));
    EXPECT_LT(*level.tone, 0.01) << "the light is the guide's everywhere";
    EXPECT_GT(*plain.tone, 1.5 * *level.tone) << "it falls off";
    EXPECT_GT(level.z, 2 * *level.tone) << "z compares what the guide stores";
    const GuideComparison forgiving(view, guide, guide), strict(evened, guide, guide);
    EXPECT_LT(forgiving.compare(photographed(guide, {}))->z, strict.compare(photographed(guide, {}))->z);
    EXPECT_LT(strict.compare(photographed(corrected, {}))->z, forgiving.compare(photographed(corrected, {}))->z);

    // A guide with little contrast, on a wall with stains.
    GreyImage faint(320, 180), stained(320, 180);
    for (int y = 0; y < 180; ++y)
        for (int x = 0; x < 320; ++x) {
            faint.at(x, y) = 0.35f + 0.1f * guide.at(x, y);
            stained.at(x, y) =
                faint.at(x, y) * (1 + 0.5f * std::sin(0.07f * static_cast<float>(x)) * std::sin(0.08f * static_cast<float>(y)));
        }
    const GuideComparison ofFaint(evened, faint, faint);
    const auto stains = *ofFaint.compare(photographed(stained, {}));
    EXPECT_GT(*stains.tone, 0.035) << "the stains are a fifth of the light, as a mean";
    EXPECT_GT(*stains.tone, 2 * stains.z) << "which z takes for exposure";
}

// The mean of some values over the cells that the camera sees.
template <class Of>
double meanInSight(const ComparedPictures& pictures, Of of) {
    double sum = 0, count = 0;
    for (int y = 0; y < pictures.inSight.height(); ++y)
        for (int x = 0; x < pictures.inSight.width(); ++x)
            if (pictures.inSight.at(x, y) > 0) sum += of(x, y), ++count;
    return sum / count;
}

TEST(GuideComparison, its_pictures_are_those_that_make_its_z) {
    const GuideComparison comparison(nominalView(), spiral(), spiral());
    for (const double degrees : {0.0, 1.0}) {
        const RgbaImage frame = photographed(spiral(), {.ambientAcross = {0.3, 0.15, 0.05}, .turned = degrees});
        const auto pictures = comparison.pictures(frame);
        ASSERT_TRUE(pictures);
        const auto magnitude = [&](int x, int y) { return std::abs(pictures->difference.at(x, y)); };
        EXPECT_NEAR(meanInSight(*pictures, magnitude), comparison.compare(frame)->z, 1e-6);
        ASSERT_EQ(pictures->seen.width(), 3 * pictures->wanted.width());
        ASSERT_EQ(pictures->seen.height(), 3 * pictures->wanted.height());
        const GreyImage seen = resized(pictures->seen, pictures->wanted.width(), pictures->wanted.height());
        const auto fromWanted = [&](int x, int y) { return std::abs(seen.at(x, y) - pictures->wanted.at(x, y)); };
        // The spiral's arms are narrower than the blur of what is wanted.
        EXPECT_LT(meanInSight(*pictures, fromWanted), 0.15);
    }
    EXPECT_FALSE(comparison.pictures(RgbaImage(320, 180))) << "the dark";
    EXPECT_FALSE(comparison.pictures(RgbaImage(32, 18))) << "a picture of another camera";
}

// Left and right, bright and dark must not be exchanged.
TEST(GuideComparison, its_pictures_show_where_light_is_missing_and_where_it_is_too_much) {
    GreyImage guide(320, 180), shown(320, 180);
    for (int y = 0; y < 180; ++y)
        for (int x = 0; x < 320; ++x) {
            guide.at(x, y) = (x / 40 + y / 60) % 2 == 0 ? 1 : 0;
            shown.at(x, y) = x < 40 && y < 60 ? 0 : x >= 280 && y < 60 ? 1 : guide.at(x, y);
        }
    const auto pictures = GuideComparison(nominalView(), guide, guide).pictures(photographed(shown, {}));
    ASSERT_TRUE(pictures);
    const int width = pictures->difference.width();
    EXPECT_LT(pictures->difference.at(width / 16, 12), -0.5) << "missing at the upper left";
    EXPECT_GT(pictures->difference.at(width * 15 / 16, 12), 0.5) << "too much at the upper right";
    EXPECT_NEAR(pictures->difference.at(width * 9 / 16, 36), 0, 0.15);
    EXPECT_GT(pictures->wanted.at(width / 16, 12), 0.4);
    EXPECT_LT(pictures->seen.at(3 * width / 16, 36), 0.3f);
    EXPECT_GT(pictures->seen.at(3 * width * 15 / 16, 36), 0.5f);
}

TEST(GuideComparison, its_pictures_leave_out_what_the_camera_does_not_see) {
    NominalView view = nominalView();
    view.camera.pose = Pose::lookingAt({0.3, 1.6, 5}, {1.5, 1.2, 0}).value();
    const GuideComparison comparison(view, spiral(), spiral());
    const auto pictures = comparison.pictures(photographed(spiral(), {}));
    ASSERT_TRUE(pictures);
    const auto cells = pictures->inSight.pixels();
    const auto hidden = std::count(cells.begin(), cells.end(), 0.0f);
    EXPECT_GT(hidden, 0);
    EXPECT_LT(hidden, static_cast<std::ptrdiff_t>(cells.size()) / 2);
    for (int y = 0; y < pictures->inSight.height(); ++y)
        for (int x = 0; x < pictures->inSight.width(); ++x)
            if (pictures->inSight.at(x, y) == 0) {
                EXPECT_EQ(pictures->wanted.at(x, y), 0) << x << ", " << y;
                EXPECT_EQ(pictures->seen.at(3 * x + 1, 3 * y + 1), 0) << x << ", " << y;
            }
}

// Only the stored pictures matter, whatever their source: a night's frames, kept as PNG, give the
// same scores again.
TEST(GuideComparison, gives_a_stored_sequence_the_same_scores) {
    const GuideComparison comparison(nominalView(), spiral(), spiral());
    const auto file = std::filesystem::path(testing::TempDir()) / "guide_comparison_frame.png";
    for (const double degrees : {0.0, 0.7, 0.0}) {
        const RgbaImage frame = photographed(spiral(), {.noise = 0.02, .turned = degrees});
        ASSERT_TRUE(writePng(file, frame));
        EXPECT_EQ(comparison.compare(readRgba(file).value()), comparison.compare(frame));
    }
    std::filesystem::remove(file);
}

}  // namespace
}  // namespace fantascope::vision
