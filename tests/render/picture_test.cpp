// Images, videos and camera pictures on the canvas.

#include "render/reference_picture.h"
#include "render/scene.h"

#include "allocations.h"
#include "core/geometry.h"
#include "scratch_folder.h"
#include "test_video.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <gtest/gtest.h>

#include <cmath>

namespace fantascope::render {
namespace {

constexpr glm::ivec2 kSize{640, 360};

template <class T>
T valueOf(Result<T> result) {
    FANTASCOPE_CHECK(result.has_value(), result.error().message());
    return std::move(result).value();
}

ImageSource image(RgbaImage picture) { return {std::make_shared<const RgbaImage>(std::move(picture))}; }

// A picture with a bit of everything: soft colours, hard discs, thin lines at several angles, fine
// grain.
RgbaImage detailed(glm::ivec2 size) {
    RgbaImage picture(size.x, size.y);
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
            const double u = (x + 0.5) / size.y, v = (y + 0.5) / size.y;
            glm::dvec3 stored(0.5 + 0.4 * std::sin(5 * u), 0.5 + 0.4 * std::sin(7 * v + 2 * u),
                              0.5 + 0.4 * std::cos(3 * u - 6 * v));
            const glm::dvec2 cell(std::fmod(u, 0.25) - 0.125, std::fmod(v, 0.25) - 0.125);
            if (std::hypot(cell.x, cell.y) < 0.06) stored = glm::dvec3(0.95, 0.9, 0.2);
            for (const double angle : {0.1, 1.1, 2.2})
                if (std::abs(std::remainder(u * std::cos(angle) + v * std::sin(angle), 0.2)) < 0.004) stored = glm::dvec3(0.03);
            const double grain = 0.06 * std::sin(12.9898 * x + 78.233 * y + 4e-3 * x * y);
            stored = glm::clamp(stored + grain, 0.0, 1.0);
            const auto byte = [](double value) { return static_cast<std::uint8_t>(std::lround(255 * value)); };
            picture.at(x, y) = {byte(stored.x), byte(stored.y), byte(stored.z), 255};
        }
    return picture;
}

// The expected drawing of a picture, point by point: each pixel is the mean light of 8 x 8 points.
// The inverse warp maps each point to the picture, where it has the light of the pixel, or, if
// `smooth`, the light interpolated between the four nearest pixels; black beyond the picture.
RgbaImage reference(const RgbaImage& picture, const std::array<glm::dvec2, 4>& corners, glm::ivec2 size, bool smooth) {
    constexpr int kPoints = 8;
    const int width = picture.width(), height = picture.height();
    Image<glm::dvec3> light(width, height);
    for (std::size_t i = 0; i < picture.pixels().size(); ++i) {
        const Rgba8 pixel = picture.pixels()[i];
        const auto linear = [&](std::uint8_t value) {
            return double{linearFromSrgb(static_cast<float>(value) / 255)} * pixel.a / 255;
        };
        light.pixels()[i] = {linear(pixel.r), linear(pixel.g), linear(pixel.b)};
    }
    const Homography back = Homography::fromCorners(rectangleCorners(width, height), corners)->inverse();
    const auto lightAt = [&](glm::dvec2 point) {
        if (point.x < 0 || point.y < 0 || point.x > width || point.y > height) return glm::dvec3(0);
        if (!smooth) return light.at(std::min(int(point.x), width - 1), std::min(int(point.y), height - 1));
        const glm::dvec2 corner = glm::floor(point - 0.5), part = point - 0.5 - corner;
        const auto texel = [&](int x, int y) {
            return light.at(std::clamp(int(corner.x) + x, 0, width - 1), std::clamp(int(corner.y) + y, 0, height - 1));
        };
        return glm::mix(glm::mix(texel(0, 0), texel(1, 0), part.x), glm::mix(texel(0, 1), texel(1, 1), part.x), part.y);
    };
    RgbaImage drawn(size.x, size.y);
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
            glm::dvec3 sum(0);
            for (int i = 0; i < kPoints * kPoints; ++i)
                sum += lightAt(back(glm::dvec2(x + (i % kPoints + 0.5) / kPoints, y + (i / kPoints + 0.5) / kPoints)));
            sum /= kPoints * kPoints;
            const auto stored = [](double value) {
                return static_cast<std::uint8_t>(std::lround(255 * srgbFromLinear(static_cast<float>(value))));
            };
            drawn.at(x, y) = {stored(sum.x), stored(sum.y), stored(sum.z), 255};
        }
    return drawn;
}

struct Placed {
    const char* name;
    std::array<glm::dvec2, 4> corners;
    glm::ivec2 picture;
    bool enlarged = false;
};
const Placed kPlaced[] = {
    {"as it is", rectangleCorners(640, 360), {640, 360}},
    {"a light keystone", keystone(kSize), {640, 360}},
    {"steep, larger than the output", {{{250, 40}, {390, 40}, {630, 350}, {10, 350}}}, {1920, 1080}},
    {"steep to the side", {{{30, 10}, {600, 140}, {600, 220}, {30, 350}}}, {1280, 720}},
    {"small", {{{200, 100}, {360, 110}, {350, 200}, {190, 190}}}, {1280, 720}},
    {"so small that it takes mipmaps", {{{300, 100}, {380, 110}, {370, 180}, {290, 170}}}, {1920, 1080}},
    {"enlarged", keystone(kSize), {160, 90}, true},
};

// Example failures: aliasing where the picture is minified, blur where it is magnified, half a
// pixel off, means of stored values instead of light.
TEST(Pictures, are_filtered_as_a_point_by_point_reference_is) {
    for (const Placed& placed : kPlaced) {
        SCOPED_TRACE(placed.name);
        const RgbaImage picture = detailed(placed.picture);
        DrawnOutput output(kSize, placed.corners, {image(picture)});
        const Difference apart = difference(output.frame({{0, 1}}), reference(picture, placed.corners, kSize, placed.enlarged));
        std::printf("%s: rms %.2f of 255, most %d\n", placed.name, apart.rms, apart.most);
        RecordProperty(placed.name, std::to_string(apart.rms));
        EXPECT_LE(apart.rms, 4);
    }
}

// A painting program may leave any colour in transparent pixels. A magnified white shape must have
// neither a dark nor a coloured seam.
TEST(Pictures, have_no_seams_at_the_edges_of_their_alpha) {
    constexpr int kEdge = 32;  // of the picture; each pixel is 10 pixels of the output
    RgbaImage cutOut(64, 36, {255, 0, 0, 0});
    for (int y = 0; y < 36; ++y)
        for (int x = 0; x < kEdge; ++x) cutOut.at(x, y) = {255, 255, 255, 255};
    DrawnOutput output(kSize, rectangleCorners(kSize.x, kSize.y), {image(cutOut)});
    const RgbaImage& drawn = output.frame({{0, 1}});
    for (int x = 0; x < kSize.x; ++x) {
        const Rgba8 pixel = drawn.at(x, 180);
        ASSERT_EQ(pixel.r, pixel.g) << x;
        ASSERT_EQ(pixel.r, pixel.b) << x;
        // The light falls from 1 to 0 between the centres of the two pixels at the edge.
        const double share = std::clamp((320 + 5 - (x + 0.5)) / 10, 0.0, 1.0);
        ASSERT_NEAR(linearFromSrgb(static_cast<float>(pixel.r) / 255), share, 0.01) << x;
    }
}

// An alpha of 0.5 gives half of the light, whatever the colour.
TEST(Pictures, are_as_bright_as_their_alpha) {
    DrawnOutput output(kSize, rectangleCorners(kSize.x, kSize.y), {image(RgbaImage(8, 8, {255, 188, 0, 128}))});
    const Rgba8 pixel = output.frame({{0, 1}}).at(320, 180);
    EXPECT_NEAR(pixel.r, 188, 1);
    EXPECT_NEAR(pixel.g, 137, 1);
    EXPECT_EQ(pixel.b, 0);
}

// This holds for every orientation, and mirrored as for rear projection.
TEST(Pictures, lie_with_their_corners_on_the_canvass) {
    const Rgba8 colours[] = {{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {255, 255, 0, 255}};
    RgbaImage picture(90, 60);
    for (int y = 0; y < 60; ++y)
        for (int x = 0; x < 90; ++x) picture.at(x, y) = colours[y < 30 ? (x < 45 ? 0 : 1) : (x < 45 ? 3 : 2)];
    auto corners = keystone(kSize);
    for (const bool mirrored : {false, true}) {
        if (mirrored) corners = {corners[1], corners[0], corners[3], corners[2]};
        DrawnOutput output(kSize, corners, {image(picture)});
        const RgbaImage& drawn = output.frame({{0, 1}});
        const glm::dvec2 middle = (corners[0] + corners[1] + corners[2] + corners[3]) / 4.0;
        for (std::size_t i = 0; i < 4; ++i) {
            const glm::ivec2 within = glm::mix(corners[i], middle, 0.2);
            EXPECT_EQ(drawn.at(within.x, within.y), colours[i]) << i;
        }
    }
}

// Shows a numbered video on an output of the same size.
class VideoOnAnOutput : public testing::Test {
protected:
    static constexpr glm::ivec2 kVideo{128, 72};

    VideoSource video(int rate, int frames, VideoStream::Pace pace = VideoStream::Pace::Exact) const {
        const auto file = folder_ / fmt::format("{}-{}.mp4", rate, frames);
        writeVideo(file, {.size = kVideo, .rate = rate, .bFrames = 3, .keyEvery = 250}, frames,
                   [](int i) { return numbered(kVideo, i + 1); });
        return {.stream = valueOf(VideoStream::open(file, pace))};
    }
    const ScratchFolder folder_;
};

// Example failures: the previous frame is shown, since the texture is drawn before it is filled; a
// frame is missing after the first loop.
TEST_F(VideoOnAnOutput, shows_the_frame_of_the_moment) {
    for (const int rate : {24, 25, 30, 60}) {
        DrawnOutput output(kVideo, rectangleCorners(kVideo.x, kVideo.y), {video(rate, 31)});
        for (std::int64_t refresh = 0; refresh < 150; ++refresh) {
            const Time time = tickTime(refresh, 60);
            ASSERT_EQ(numberOn(output.frame({{0, 1}}, time)), refresh * rate / 60 % 31 + 1) << rate << " Hz, refresh " << refresh;
        }
    }
}

TEST_F(VideoOnAnOutput, holds_its_last_frame_where_it_does_not_loop_and_goes_at_its_speed) {
    VideoSource once = video(25, 20), slow = video(25, 21);
    once.times = 1;
    slow.speed = 0.5;
    DrawnOutput output(kVideo, rectangleCorners(kVideo.x, kVideo.y), {once, slow});
    const auto shown = [&](std::uint32_t source, Time time) { return numberOn(output.frame({{source, 1}}, time)); };
    EXPECT_EQ(shown(0, tickTime(19, 25)), 20);
    EXPECT_EQ(shown(0, std::chrono::hours(9)), 20);
    EXPECT_EQ(shown(0, tickTime(3, 25)), 4);
    EXPECT_EQ(shown(1, tickTime(3, 25)), 2);
    EXPECT_EQ(shown(1, tickTime(4, 25)), 3);
    EXPECT_EQ(shown(1, tickTime(41, 25)), 21);
    EXPECT_EQ(shown(1, tickTime(42, 25)), 1);
}

TEST_F(VideoOnAnOutput, is_dark_after_its_end_where_it_is_asked_to) {
    VideoSource once = video(25, 20);
    once.times = 1;
    once.endsDark = true;
    DrawnOutput output(kVideo, rectangleCorners(kVideo.x, kVideo.y), {once});
    EXPECT_EQ(numberOn(output.frame({{0, 1}}, tickTime(19, 25))), 20);
    const RgbaImage over = output.frame({{0, 1}}, tickTime(20, 25));
    EXPECT_TRUE(std::ranges::all_of(over.pixels(), [](const Rgba8& pixel) { return pixel == Rgba8{0, 0, 0}; }));
}

// In steady state the render thread only copies, at either pace, even if the picture changes every
// frame.
TEST_F(VideoOnAnOutput, allocates_nothing_once_it_runs) {
    const auto feed = std::make_shared<PictureFeed>(kVideo);
    DrawnOutput output(kSize, keystone(kSize),
                       {video(30, 20), video(30, 21, VideoStream::Pace::Live), image(detailed({320, 180})), CameraSource{feed}});
    const show::OutputState look{{{0, 0.5f}, {1, 0.5f}, {2, 0.1f}, {3, 0.2f}}};
    const auto seen = std::make_shared<const RgbaImage>(numbered(kVideo, 77));
    for (int frame = 0; frame < 3; ++frame) output.frame(look, tickTime(frame, 30));
    std::int64_t allocated = 0;
    for (int frame = 3; frame < 60; ++frame) {
        feed->publish(seen);
        const std::int64_t before = allocationsSoFar();
        output.frame(look, tickTime(frame, 30));
        allocated += allocationsSoFar() - before;
    }
    EXPECT_EQ(allocated, 0);
}

TEST(CameraOnAnOutput, shows_the_newest_picture_and_nothing_before_the_first) {
    constexpr glm::ivec2 kCamera{128, 72};
    const auto feed = std::make_shared<PictureFeed>(kCamera);
    const auto see = [&](int number) { feed->publish(std::make_shared<const RgbaImage>(numbered(kCamera, number))); };
    see(9);  // there is no reader yet
    DrawnOutput left(kCamera, rectangleCorners(kCamera.x, kCamera.y), {CameraSource{feed}});
    for (const Rgba8 pixel : left.frame({{0, 1}}).pixels()) ASSERT_EQ(pixel, (Rgba8{0, 0, 0, 255}));
    DrawnOutput right(kCamera, rectangleCorners(kCamera.x, kCamera.y), {CameraSource{feed}});
    for (const int number : {3, 500, 40000}) {
        see(1);
        see(number);
        EXPECT_EQ(numberOn(left.frame({{0, 1}})), number);
        EXPECT_EQ(numberOn(right.frame({{0, 1}})), number);
        EXPECT_EQ(numberOn(left.frame({{0, 1}})), number);
    }
    feed->publish(std::make_shared<const RgbaImage>(64, 64));
    EXPECT_EQ(numberOn(left.frame({{0, 1}})), 40000) << "a picture of another size is ignored";
}

}  // namespace
}  // namespace fantascope::render
