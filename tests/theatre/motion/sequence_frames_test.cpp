#include "theatre/motion/sequence_frames.h"

#include <gmock/gmock.h>

namespace fantascope::theatre {
namespace {

using testing::ElementsAre;
using testing::FieldsAre;

// A square of 10 x 10 that stands at each of the columns in turn.
std::vector<BitMask> squares(const std::vector<int>& columns) {
    std::vector<BitMask> frames;
    for (const int column : columns) {
        BitMask& mask = frames.emplace_back(100, 20);
        for (int y = 5; y < 15; ++y) mask.fill(y, column, column + 10);
    }
    return frames;
}

TEST(SequenceFrames, the_middle_one_has_the_shortest_way_to_all) {
    // 8 of 12 columns in common are two thirds, 6 of 14 three sevenths, 4 of 16 a quarter.
    EXPECT_THAT(leastOverlaps(squares({20, 22, 24, 26})), ElementsAre(0.25, 3.0 / 7, 3.0 / 7, 0.25));
    EXPECT_THAT(leastOverlaps(squares({20})), ElementsAre(1));
    const std::vector<double> least{0.4, 0.44, 0.46, 0.46};
    EXPECT_EQ(middleFrame(least), 2u);
    EXPECT_TRUE(isOffTheMiddle(0, least));
    EXPECT_FALSE(isOffTheMiddle(1, least)) << "not by so much that it would be told";
    // Of very many only some are looked at, those at the ends among them.
    std::vector<int> columns(3 * kLooks, 24);
    columns.front() = 20;
    EXPECT_NEAR(leastOverlaps(squares(columns))[5], 3.0 / 7, 1e-12);
}

TEST(SequenceFrames, a_jump_is_found_where_it_is) {
    EXPECT_THAT(jumpsOf(squares({20, 22, 24, 60, 62}), false), ElementsAre(FieldsAre(2u, 3u, 0.0)));
    // Around the end, in a loop alone.
    EXPECT_THAT(jumpsOf(squares({20, 22, 24, 26}), false), ElementsAre());
    EXPECT_THAT(jumpsOf(squares({20, 22, 24, 26}), true), ElementsAre(FieldsAre(3u, 0u, 0.25)));
    EXPECT_THAT(jumpsOf(squares({20}), true), ElementsAre());
}

// Each in a frame of its own: what is wider has a wider mask.
TEST(SequenceFrames, know_the_frame_that_poses_for_a_picture_are_of) {
    const auto bar = [](int width) {
        GreyImage picture(200, 120);
        for (int y = 10; y < 110; ++y)
            for (int x = 100 - width / 2; x < 100 + width / 2; ++x) picture.at(x, y) = 1;
        return PoseTarget::from(picture, {}, 1, 96).value();
    };
    const std::vector<PoseTarget> frames{bar(40), bar(80), bar(160)};
    EXPECT_NEAR(overlap(frames[0], frames[1]), 0.5, 0.02);
    const Likeness same = mostAlike(frames, bar(82));
    EXPECT_EQ(same.frame, 1u);
    EXPECT_TRUE(same.isEnough());
    const Likeness other = mostAlike(frames, bar(120));
    EXPECT_EQ(other.frame, 2u);
    EXPECT_FALSE(other.isEnough());
    EXPECT_EQ(mostAlike(std::vector{bar(60), bar(60)}, bar(60)).frame, 0u) << "of several the first";
}

}  // namespace
}  // namespace fantascope::theatre
