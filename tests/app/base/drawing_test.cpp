#include "app/base/drawing.h"

#include "scratch_folder.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

namespace fantascope::app {
namespace {

using testing::HasSubstr;

// Discs of light on black.
GreyImage discs(std::initializer_list<std::pair<glm::dvec2, double>> all, float value = 1) {
    GreyImage drawing(200, 200);
    for (const auto& [middle, radius] : all)
        for (int y = 0; y < 200; ++y)
            for (int x = 0; x < 200; ++x)
                if (glm::distance(glm::dvec2(x, y) + 0.5, middle) < radius) drawing.at(x, y) = value;
    return drawing;
}

// Example failure: half a minute's search for a pattern of nothing.
TEST(Drawing, of_one_grey_all_over_is_refused) {
    for (const auto& [value, word] : {std::pair(0.0f, "black"), {0.5f, "one grey"}, {1.0f, "white"}})
        EXPECT_THAT(checkDrawn(GreyImage(64, 36, value), "a.png").error().message(), HasSubstr(word));
    EXPECT_TRUE(checkDrawn(discs({{{100, 100}, 3}}), "a.png"));
    EXPECT_TRUE(checkDrawn(discs({{{100, 100}, 30}}, 0.02f), "a.png")) << "faint is drawn, too";
}

TEST(Drawing, in_dark_ink_on_white_paper_is_known) {
    const GreyImage light = discs({{{100, 100}, 40}});
    EXPECT_FALSE(isInkOnPaper(light));
    EXPECT_TRUE(isInkOnPaper(inverted(light)));
    GreyImage scanned = inverted(discs({{{100, 100}, 10}}));
    for (float& value : scanned.pixels()) value = 0.12f + 0.8f * value;
    EXPECT_TRUE(isInkOnPaper(scanned)) << "grey paper, worn ink";
    EXPECT_FALSE(isInkOnPaper(GreyImage(64, 64, 1))) << "paper alone";
    EXPECT_FALSE(isInkOnPaper(discs({{{100, 100}, 99}}))) << "a large shape of light has a black edge around";
    EXPECT_FALSE(isInkOnPaper(discs({{{100, 100}, 150}}, 0.7f))) << "a bright drawing is no paper";
}

TEST(Drawing, a_hole_too_small_for_people_is_told_with_its_place) {
    GreyImage silhouette = discs({{{100, 100}, 80}});
    EXPECT_EQ(oddHolesIn(silhouette), "");
    const auto cut = [&](glm::ivec2 from, int side) {
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) silhouette.at(from.x + x, from.y + y) = 0;
    };
    cut({60, 60}, 30);
    EXPECT_EQ(oddHolesIn(silhouette), "") << "an arm may stand so";
    cut({120, 110}, 2);
    EXPECT_THAT(oddHolesIn(silhouette), testing::AllOf(HasSubstr("it has a hole of less than 2 %"), HasSubstr("row 11")));
    cut({130, 90}, 1);
    EXPECT_THAT(oddHolesIn(silhouette), HasSubstr("it has 2 holes"));
    EXPECT_EQ(oddHolesIn(GreyImage(20, 20)), "");
}

}  // namespace
}  // namespace fantascope::app
