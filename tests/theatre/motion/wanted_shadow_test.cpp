#include "theatre/motion/wanted_shadow.h"

#include "theatre/deform/silhouette_sequence.h"

#include "core/file.h"
#include "pictures.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <string>
#include <vector>

namespace fantascope::theatre {
namespace {

using testing::HasSubstr;

// Pictures of 60 x 50 pixels with a silhouette of 20 x 40 pixels, 5 pixels above the lower edge.
GreyImage barAt(int left) {
    return pictureOf(60, 50, [left](int x, int y) { return isIn(x, y, left, 5, 20, 40); });
}

class WantedShadowTest : public testing::Test {
protected:
    // The silhouette is 2 m high, so a pixel is 5 cm; its middle is in front of the light, at x =
    // 0.3.
    WantedShadowTest() {
        EXPECT_TRUE(writePng(folder_ / "bar.png", barAt(10)));
        cast_.targets[0].file = folder_ / "bar.png";
        cast_.targets[0].height = 2;
        cast_.stage.beams[0].light = {0.3, 1, 7};
        cast_.actors.push_back({1.7, std::vector<ActorPose>(1)});
    }
    // Three pictures in which the bar goes to the right by 10 pixels each. The second is the
    // target.
    void follow(std::size_t first, std::size_t frames) {
        SilhouetteSequence sequence;
        for (int i = 0; i < 3; ++i) {
            sequence.pictures.push_back(folder_ / fmt::format("{}.png", i));
            EXPECT_TRUE(writePng(sequence.pictures.back(), barAt(10 + 10 * i)));
        }
        EXPECT_TRUE(writeSequence(folder_ / "sequence.yaml", sequence));
        cast_.sequence = Cast::Sequence{folder_ / "sequence.yaml", 1, first};
        cast_.framesPerSecond = 10;
        cast_.actors[0].poses.resize(frames);
    }
    // A canvas of 4 m x 3 m, in pixels of 5 cm.
    Result<WantedShadow> wanted(std::size_t beam = 0) const { return wantedShadow(cast_, beam, {-2, -0.5}, {2, 2.5}, 60); }
    // The bar's left edge on the canvas, metres. Also checks that it is the bar.
    static double leftOf(const GreyImage& picture) {
        EXPECT_EQ(picture.width(), 80);
        int left = 0;
        while (left < picture.width() && picture.at(left, 30) < 0.5f) ++left;
        const GreyImage expected = pictureOf(80, 60, [left](int x, int y) { return isIn(x, y, left, 10, 20, 40); });
        EXPECT_EQ(picture, expected);
        return -2 + 0.05 * left;
    }
    const ScratchFolder folder_;
    Cast cast_;
};

TEST_F(WantedShadowTest, places_a_still_as_the_search_does) {
    const auto shadow = wanted();
    ASSERT_TRUE(shadow) << shadow.error().message();
    ASSERT_EQ(shadow->frames.size(), 1u);
    EXPECT_NEAR(leftOf(shadow->at(0)), 0.3 - 0.5, 1e-9);
    EXPECT_EQ(shadow->counted, pictureOf(80, 60, [](int, int y) { return y < 50; })) << "above the floor";
}

TEST_F(WantedShadowTest, follows_the_sequence_from_the_frame_of_the_first_poses) {
    follow(2, 3);
    const auto shadow = wanted();
    ASSERT_TRUE(shadow) << shadow.error().message();
    ASSERT_EQ(shadow->frames.size(), 3u);
    EXPECT_NEAR(leftOf(shadow->at(0)), 0.3, 1e-9) << "the third picture";
    EXPECT_NEAR(leftOf(shadow->at(0.6)), -0.7, 1e-9) << "the first picture, in the nearest frame";
    EXPECT_NEAR(leftOf(shadow->at(1.6)), -0.2, 1e-9);
    EXPECT_NEAR(leftOf(shadow->at(2.7)), 0.3, 1e-9) << "the loop's first frame is near again";
}

TEST_F(WantedShadowTest, counts_only_what_the_projector_lights) {
    cast_.stage.beams[0].lit = Stage::Area{{-1, 0}, {1.5, 2.2}};
    const auto shadow = wanted();
    ASSERT_TRUE(shadow) << shadow.error().message();
    EXPECT_EQ(shadow->counted, pictureOf(80, 60, [](int x, int y) { return isIn(x, y, 20, 6, 50, 44); }));
}

TEST_F(WantedShadowTest, says_what_is_missing) {
    const auto error = [](const Result<WantedShadow>& result) { return result ? "" : result.error().message(); };
    EXPECT_THAT(error(wanted(1)), HasSubstr("no target for beam 2"));
    std::filesystem::remove(folder_ / "bar.png");
    EXPECT_THAT(error(wanted()), HasSubstr("bar.png"));
    follow(0, 2);
    std::filesystem::remove(folder_ / "1.png");
    EXPECT_THAT(error(wanted()), HasSubstr("1.png"));
}

}  // namespace
}  // namespace fantascope::theatre
