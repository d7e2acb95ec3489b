// config/simulated/site.yaml: its corners match its drawings, and what its camera sees.

#include "drivers/default_site.h"

#include "core/geometry.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

namespace fantascope::site {
namespace {

constexpr double kAspect = 16.0 / 9;

// Where the two pictures should be: 5.12 m x 2.88 m, 0.9 m above the ground, 0.8 m either side of
// the middle.
std::array<glm::dvec3, 4> pictureOnWall(const std::string& output) {
    const double left = output == "left" ? -0.8 - 5.12 : 0.8, bottom = 0.9;
    return {{{left, bottom + 2.88, 0}, {left + 5.12, bottom + 2.88, 0}, {left + 5.12, bottom, 0}, {left, bottom, 0}}};
}

// If you move a projector in the file, copy the corners that this test prints.
TEST(DefaultSite, corners_put_each_canvas_on_its_rectangle) {
    const show::Site site = defaultSite();
    const NominalSite nominal = nominalPartsOf(site);
    ASSERT_EQ(site.outputs.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        const show::Output& output = site.outputs[i];
        const vision::CameraModel& projector = nominal.outputs[i].projector;
        const auto picture = pictureOnWall(output.name);
        const auto corners = vision::rectifyingCorners(projector, picture);
        ASSERT_TRUE(corners) << corners.error().message();
        std::string line = output.name + ":";
        for (const glm::dvec2 corner : *corners) line += fmt::format(" [{:.2f}, {:.2f}]", corner.x, corner.y);
        const Homography projectorFromCanvas =
            *Homography::fromCorners(rectangleCorners(kAspect, 1), output.projection.warp.shape().corners);
        for (const glm::dvec2 canvas :
             {glm::dvec2(0, 0), glm::dvec2(kAspect, 0), glm::dvec2(kAspect / 2, 0.5), glm::dvec2(0.3, 1)}) {
            const glm::dvec3 wanted =
                picture[0] + (picture[1] - picture[0]) * (canvas.x / kAspect) + (picture[3] - picture[0]) * canvas.y;
            const auto pixel = projector.pixelFromWorld(wanted);
            EXPECT_LT(glm::distance(projectorFromCanvas(canvas), pixel.value()), 0.5) << line;
        }
        // So far off its axis that an uncorrected picture would be visibly crooked: its sides
        // differ by more than a tenth.
        const double left = glm::distance((*corners)[0], (*corners)[3]), right = glm::distance((*corners)[1], (*corners)[2]);
        EXPECT_GT(std::abs(left - right), 0.1 * std::min(left, right));
    }
}

TEST(DefaultSite, camera_sees_both_pictures_whole_and_apart) {
    const NominalSite nominal = nominalPartsOf(defaultSite());
    double lastOfLeft = 0, firstOfRight = 480;
    for (const auto& output : nominal.outputs)
        for (const glm::dvec3& corner : pictureOnWall(output.name)) {
            const auto pixel = nominal.camera->pixelFromWorld(corner);
            ASSERT_TRUE(pixel && nominal.camera->inPicture(*pixel));
            if (output.name == "left") lastOfLeft = std::max(lastOfLeft, pixel->x);
            if (output.name == "right") firstOfRight = std::min(firstOfRight, pixel->x);
        }
    EXPECT_LT(lastOfLeft + 20, firstOfRight);
}

// The mean stored green of a block of the camera's picture around a point of the site.
double greyAround(const RgbaImage& image, const vision::CameraModel& camera, glm::dvec3 point) {
    const glm::ivec2 pixel = camera.pixelFromWorld(point).value();
    double sum = 0;
    for (int y = -2; y <= 2; ++y)
        for (int x = -2; x <= 2; ++x) sum += image.at(pixel.x + x, pixel.y + y).g;
    return sum / 25;
}

TEST(DefaultSite, is_dark_until_its_lights_come_on) {
    const show::Site site = defaultSite();
    const NominalSite nominal = nominalPartsOf(site);
    ManualClock clock;
    World world(clock);
    const auto opened = SimulatedSite::open(site.simulation.value(), nominal, 1, world);
    ASSERT_TRUE(opened) << opened.error().message();
    world.installRelays("road", {false, false});
    (*opened)->begin(Time{});
    std::int64_t frames = 0;
    const auto seen = [&] {
        const Time exposed = tickTime(frames++, 10);
        clock.advanceTo(exposed);
        (*opened)->advanceTo(exposed);
        clock.advanceTo(exposed + fromSeconds(0.06));
        return world.takeFromCamera()->image;
    };
    const glm::dvec3 leftPicture(-3.4, 2.3, 0), rightPicture(3.4, 2.3, 0), blade(-0.05, 2.2, 1.4), besideNorthPole(-5.6, 3.2, 0),
        besideSouthPole(5.6, 3.2, 0);
    const auto grey = [&](const RgbaImage& image, glm::dvec3 point) { return greyAround(image, *nominal.camera, point); };
    const RgbaImage dark = seen();
    for (const glm::dvec3& point : {leftPicture, rightPicture, blade, besideNorthPole, besideSouthPole})
        EXPECT_LT(grey(dark, point), 45);

    std::array<std::uint8_t, kDmxSlots> slots{};
    slots[0] = 255;
    world.setSlots(1, slots);
    const RgbaImage lamp = seen();
    EXPECT_GT(grey(lamp, blade), 120) << "the sculpture's upper part";
    EXPECT_LT(grey(lamp, leftPicture), 45) << "the lamp spares the pictures";
    EXPECT_LT(grey(lamp, rightPicture), 45);

    slots[0] = 0;
    world.setSlots(1, slots);
    world.setRelays("road", {true, false});
    const RgbaImage north = seen();
    EXPECT_GT(grey(north, besideNorthPole), 80);
    EXPECT_LT(grey(north, besideSouthPole), 45);

    world.setRelays("road", {false, false});
    world.setFrame("right", std::make_shared<const RgbaImage>(640, 360, Rgba8{255, 255, 255, 255}));
    const RgbaImage projector = seen();
    EXPECT_GT(grey(projector, rightPicture), 200);
    EXPECT_LT(grey(projector, leftPicture), 45);
}

}  // namespace
}  // namespace fantascope::site
