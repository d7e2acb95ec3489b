// A person with the board before a camera, frame by frame.

#include "app/lens/board_watch.h"

#include "app/lens/lens_result.h"

#include "vision/board_pictures.h"

#include <gmock/gmock.h>

namespace fantascope::app {
namespace {

using testing::HasSubstr;
using testing::Not;
using vision::BoardCamera;
using vision::BoardPose;
using vision::CameraModel;

class Watched : public testing::Test {
protected:
    RgbaImage frame(const BoardPose& pose) { return camera_.picture(pose, rng_); }
    // Held still at a place for some frames.
    void hold(const BoardPose& pose) {
        for (int i = 0; i < 3; ++i) watch_.look(frame(pose));
    }

    const CameraModel lens_ = *CameraModel::fromFieldOfView(Pose(), {480, 360}, 1.05, -0.1, 0.02);
    const BoardCamera camera_{lens_};
    Rng rng_{8};
    BoardWatch watch_;
};

TEST_F(Watched, counts_a_place_once_and_only_when_the_board_stands_still) {
    const BoardPose here{{0, 0, 14}, {20, 0, 0}};
    EXPECT_FALSE(watch_.look(frame(here))) << "nobody knows yet whether it stands";
    EXPECT_TRUE(watch_.look(frame(here)));
    EXPECT_FALSE(watch_.look(frame(here)));
    EXPECT_THAT(watch_.advice(), HasSubstr("hold the board at the"));
    for (int i = 1; i < 8; ++i) EXPECT_FALSE(watch_.look(frame({{0.3 * i, 0, 14}, {20, 0, 0}}))) << "it moves";
    EXPECT_EQ(watch_.views().size(), 1u);
    EXPECT_FALSE(watch_.isComplete());
}

TEST_F(Watched, is_complete_once_the_board_was_everywhere) {
    double done = 0;
    for (const BoardPose& pose : camera_.poses(40, rng_)) {
        if (watch_.isComplete()) break;
        hold(pose);
        EXPECT_GE(watch_.done(), done - 0.35);
        done = watch_.done();
    }
    EXPECT_TRUE(watch_.isComplete()) << watch_.advice();
    EXPECT_EQ(watch_.done(), 1);
    EXPECT_GE(watch_.views().size(), 15u);
    const auto result = lensOf(watch_.views(), watch_.missed());
    ASSERT_TRUE(result);
    EXPECT_TRUE(result->isGood()) << result->trouble;
    EXPECT_NEAR(result->fit.lens.focal, lens_.focal, 3);
}

// What was thrown away does not spoil the result, and its place is free for another view.
TEST_F(Watched, throws_a_view_away_that_does_not_fit) {
    const std::vector<BoardPose> poses = camera_.poses(9, rng_);
    for (std::size_t i = 0; i < 8; ++i) hold(poses[i]);
    const std::size_t before = watch_.views().size();
    RgbaImage bent = frame(poses[8]);
    const RgbaImage straight = bent;
    for (int y = 0; y < bent.height(); ++y)
        for (int x = 0; x < bent.width(); ++x) {
            const int from = std::clamp(x + static_cast<int>(std::lround(6 * std::sin(y / 25.0))), 0, bent.width() - 1);
            bent.at(x, y) = straight.at(from, y);
        }
    watch_.look(bent);
    watch_.look(bent);
    EXPECT_EQ(watch_.thrownAway(), 1);
    EXPECT_EQ(watch_.views().size(), before);
    hold(poses[8]);
    EXPECT_EQ(watch_.views().size(), before + 1);
}

// Whether the board is on the picture or not.
TEST_F(Watched, says_that_the_camera_is_frozen) {
    const RgbaImage board = frame({{0, 0, 14}, {20, 0, 0}});
    for (int i = 0; i < 10; ++i) {
        watch_.look(board);
        EXPECT_THAT(watch_.advice(), Not(HasSubstr("repeats"))) << i;
    }
    watch_.look(board);
    EXPECT_THAT(watch_.advice(), HasSubstr("the camera repeats one picture: unplug it"));
    hold({{1, 0, 14}, {20, 0, 0}});
    EXPECT_THAT(watch_.advice(), Not(HasSubstr("repeats")));

    BoardWatch empty;
    for (int i = 0; i < 12; ++i) empty.look(RgbaImage(480, 360, {90, 90, 90, 255}));
    EXPECT_THAT(lensOf({}, empty.missed()).error().message(), HasSubstr("repeats one picture"));
}

TEST_F(Watched, says_what_is_wrong_with_a_picture) {
    watch_.look(RgbaImage(480, 360));
    EXPECT_THAT(watch_.advice(), HasSubstr("black"));
    watch_.look(RgbaImage(480, 360, {255, 255, 255, 255}));
    EXPECT_THAT(watch_.advice(), HasSubstr("white"));
    watch_.look(RgbaImage(480, 360, {90, 90, 90, 255}));
    EXPECT_EQ(watch_.advice(), "show the board to the camera");
    EXPECT_THAT(lensOf({}, watch_.missed()).error().message(), HasSubstr("no board was found"));
}

}  // namespace
}  // namespace fantascope::app
