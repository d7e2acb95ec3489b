#include "theatre/energy/pose_problem.h"

#include "theatre/a_stage.h"

#include "pictures.h"
#include "source_folder.h"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

namespace fantascope::theatre {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const Stage kStage = aStage({0.5, 0.1, 7});

std::string messageOf(const GreyImage& picture) {
    const auto target = PoseTarget::from(picture, kStage, 2, 128);
    return target ? "none" : target.error().message();
}

// An L, far from the picture's middle, of 100 x 200 pixels: 2 m high it is 1 m wide.
TEST(PoseTarget, stands_on_the_floor_before_the_light_as_high_as_asked) {
    const GreyImage picture =
        pictureOf(400, 300, [](int x, int y) { return isIn(x, y, 270, 60, 40, 200) || isIn(x, y, 270, 220, 100, 40); });
    const auto target = PoseTarget::from(picture, kStage, 2, 128);
    ASSERT_TRUE(target);
    const ScreenFrame& frame = target->frame;
    EXPECT_DOUBLE_EQ(frame.pixel(), 2.0 / 128);
    const auto isWhiteAt = [&](double x, double y) {
        const glm::dvec2 pixel = frame.pixelAt(x, y);
        return target->mask.at(static_cast<int>(std::floor(pixel.x)), static_cast<int>(std::floor(pixel.y)));
    };
    // The foot from 0 to 1 m, the stem from 0 to .4; half a pixel of leeway.
    const double e = 0.6 * frame.pixel();
    EXPECT_TRUE(isWhiteAt(0 + e, 0 + e));
    EXPECT_TRUE(isWhiteAt(1 - e, 0 + e));
    EXPECT_FALSE(isWhiteAt(1 + e, 0.2));
    EXPECT_FALSE(isWhiteAt(0 - e, 0.2));
    EXPECT_TRUE(isWhiteAt(0 + e, 2 - e));
    EXPECT_FALSE(isWhiteAt(0 + e, 2 + e));
    EXPECT_TRUE(isWhiteAt(0.4 - e, 1));
    EXPECT_FALSE(isWhiteAt(0.4 + e, 1));
    // Below the floor there is no picture; around it a third of the height.
    EXPECT_NEAR(frame.metresAt({0, frame.height()}).y, 0, 1e-12);
    EXPECT_NEAR(frame.metresAt({0, 0}).y, 2 * (1 + 1 / 3.0), 0.02);
    EXPECT_NEAR(frame.metresAt({0, 0}).x, 0 - 2 / 3.0, 0.02);
    // The picture as it was given reaches below the floor: the silhouette's foot is in its row 260,
    // its left in column 270.
    EXPECT_EQ(target->given.width(), 400);
    EXPECT_EQ(target->given.height(), 300);
    EXPECT_NEAR(target->given.metresAt({270, 260}).x, 0, 1e-12);
    EXPECT_NEAR(target->given.metresAt({270, 260}).y, 0, 1e-12);
    EXPECT_NEAR(target->given.metresAt({370, 60}).x, 1, 1e-12);
    EXPECT_NEAR(target->given.metresAt({370, 60}).y, 2, 1e-12);
    EXPECT_NEAR(target->halved(kStage).given.metresAt({370, 60}).y, 2, 1e-12);
    EXPECT_EQ(target->mask.rowsTo() - target->mask.rowsFrom(), 128);
    EXPECT_EQ(target->area, static_cast<double>(target->mask.count()));
    EXPECT_NEAR(target->area, (40 * 200 + 60 * 40) * 0.64 * 0.64, 128);
    EXPECT_EQ(target->refPixelsPerPixel, 2);
    ASSERT_EQ(target->contour.size(), kContourPoints / 2);
    for (const ContourPoint& point : target->contour) EXPECT_TRUE(target->mask.at(point.pixel.x, point.pixel.y));
}

// A box 1 m wide and 2 m high: x 0 .. 1, since the light is at .5.
TEST(PoseTarget, lies_in_what_a_projector_lights) {
    const GreyImage picture = pictureOf(300, 300, [](int x, int y) { return isIn(x, y, 100, 50, 100, 200); });
    Stage stage = kStage;
    const auto message = [&](Stage::Area lit) {
        stage.beams[0].lit = lit;
        const auto target = PoseTarget::from(picture, stage, 2, 128);
        return target ? "none" : target.error().message();
    };
    EXPECT_EQ(message({{-0.01, 0}, {1.01, 2.01}}), "none");
    EXPECT_THAT(message({{0.1, 0}, {1.01, 2.01}}),
                AllOf(HasSubstr("x 0.00 .. 1.00 m and y 0 .. 2.00 m"), HasSubstr("lights x 0.10 .. 1.01 m")));
    EXPECT_THAT(message({{-1, 0}, {0.9, 2.01}}), HasSubstr("lights"));
    EXPECT_THAT(message({{-1, 0.1}, {2, 2.01}}), HasSubstr("lights"));
    EXPECT_THAT(message({{-1, 0}, {2, 1.9}}), HasSubstr("make it less high"));
}

TEST(PoseTarget, has_the_same_contour_from_a_larger_picture) {
    const auto disc = [](int size) {
        return pictureOf(size, size, [&](int x, int y) { return std::hypot(x - size / 2, y - size / 2) < 0.4 * size; });
    };
    const auto small = PoseTarget::from(disc(700), kStage, 2, 512), large = PoseTarget::from(disc(1600), kStage, 2, 512);
    ASSERT_TRUE(small && large);
    EXPECT_LT(static_cast<double>(differing(small->mask, large->mask)), 0.02 * large->area);
    // A curvature of 1 / 128 pixels of 256, in 1 / kDiscRadius.
    double mean = 0;
    for (const ContourPoint& point : large->contour) mean += point.curvature / kContourPoints;
    EXPECT_NEAR(mean, kDiscRadius / 128, 0.1);
}

TEST(PoseTarget, refuses_what_is_no_silhouette) {
    EXPECT_THAT(messageOf(GreyImage(50, 50)), HasSubstr("nothing in it is white"));
    EXPECT_THAT(messageOf(GreyImage(50, 50, 1.0f)), HasSubstr("all of it is white"));
    EXPECT_THAT(messageOf(pictureOf(50, 50, [](int x, int y) { return isIn(x, y, 20, 30, 3, 1); })),
                AllOf(HasSubstr("column 20, row 30"), HasSubstr("3 pixels"), HasSubstr("remove")));
    // A speck beside a large one.
    EXPECT_THAT(
        messageOf(pictureOf(200, 200, [](int x, int y) { return isIn(x, y, 50, 50, 100, 100) || isIn(x, y, 160, 60, 2, 2); })),
        AllOf(HasSubstr("column 160, row 60"), HasSubstr("4 pixels")));
    EXPECT_THAT(messageOf(pictureOf(10000, 20, [](int x, int) { return x > 100; })),
                AllOf(HasSubstr("10000 x 20"), HasSubstr("2048")));
    EXPECT_THAT(messageOf(pictureOf(1000, 100, [](int x, int y) { return isIn(x, y, 10, 50, 900, 10); })),
                HasSubstr("times as wide"));
}

TEST(PoseTarget, takes_parts_that_are_near_and_refuses_those_that_are_far) {
    const auto parts = [](int gap) {
        return pictureOf(400, 200,
                         [&](int x, int y) { return isIn(x, y, 10, 50, 50, 100) || isIn(x, y, 60 + gap, 50, 80, 100); });
    };
    const auto near = PoseTarget::from(parts(5), kStage, 2, 128);
    ASSERT_TRUE(near);
    // Both are there, and their middle is in front of the light.
    EXPECT_NEAR(near->area, 130 * 100 * 1.28 * 1.28, 300);
    int left = near->mask.width(), right = 0;
    for (int x = 0; x < near->mask.width(); ++x)
        if (near->mask.at(x, near->mask.height() - 10)) left = std::min(left, x), right = std::max(right, x + 1);
    EXPECT_NEAR(near->frame.metresAt({0.5 * (left + right), 0}).x, kStage.beams[0].light.x, near->frame.pixel());
    EXPECT_THAT(messageOf(parts(40)), AllOf(HasSubstr("2 parts"), HasSubstr("join")));
    // Three in a row, each near to the next.
    EXPECT_EQ(messageOf(pictureOf(400, 200,
                                  [&](int x, int y) {
                                      return isIn(x, y, 10, 50, 50, 100) || isIn(x, y, 65, 50, 50, 100) ||
                                             isIn(x, y, 120, 50, 50, 100);
                                  })),
              "none");
}

TEST(PoseTarget, is_one_island_whatever_the_shape_of_its_parts) {
    // A U whose arms meet below, a spiral of runs that join late, and a staircase over corners.
    EXPECT_EQ(messageOf(pictureOf(100, 100,
                                  [](int x, int y) {
                                      return isIn(x, y, 10, 10, 5, 80) || isIn(x, y, 80, 10, 1, 80) || isIn(x, y, 10, 88, 71, 2);
                                  })),
              "none");
    EXPECT_EQ(messageOf(pictureOf(100, 100, [](int x, int y) { return x == y; })), "none");
    EXPECT_EQ(messageOf(pictureOf(100, 100, [](int x, int y) { return x + y == 99; })), "none");
}

TEST(PoseTarget, takes_the_projects_silhouettes) {
    int count = 0;
    for (const auto& file : std::filesystem::recursive_directory_iterator(sourceFolder() + "/assets/silhouettes")) {
        if (file.path().extension() != ".png") continue;
        const auto picture = readGrey(file.path());
        ASSERT_TRUE(picture);
        const auto target = PoseTarget::from(*picture, kStage, 2, 256);
        EXPECT_TRUE(target) << file.path() << ": " << (target ? "" : target.error().message());
        ++count;
    }
    EXPECT_GE(count, 12);
}

}  // namespace
}  // namespace fantascope::theatre
