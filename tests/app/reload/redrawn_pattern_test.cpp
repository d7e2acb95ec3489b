// A pattern whose drawing was saved goes on from where it is.

#include "app/reload/redrawn_pattern.h"

#include "app/running_show.h"

#include "pattern/search/pattern_search.h"
#include "pattern/search_helpers.h"

#include "scratch_folder.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace fantascope::app {
namespace {

using testing::HasSubstr;

// A grey disc, and a second, smaller one if it is wanted.
RgbaImage drawing(bool hasSecond, int width = 320) {
    RgbaImage image(width, 180);
    const auto light = [](double x, double y, double radius) { return std::clamp(1.3 - std::hypot(x, y) / radius, 0.0, 0.8); };
    for (int y = 0; y < 180; ++y)
        for (int x = 0; x < width; ++x) {
            const double first = light(x - 100, y - 90, 60), second = hasSecond ? light(x - 250, y - 60, 30) : 0;
            const auto grey = static_cast<std::uint8_t>(255 * std::max(first, second));
            image.at(x, y) = {grey, grey, grey};
        }
    return image;
}

pattern::ShapePattern found(const ScratchFolder& folder) {
    EXPECT_TRUE(writePng(folder / "guide.png", drawing(false)));
    pattern::PatternSearch::Options options;
    options.instances = 300;
    options.iterations = 60;
    auto found = pattern::withShapes({"leaf"});
    found.compare = pattern::CompareSpace::Light;
    found.guide = folder / "guide.png";
    const GreyImage guide = comparedGuide(valueOf(readGrey(found.guide)), found.guideTransfer, found.compare);
    return pattern::PatternSearch::run(guide, found, options, 1, pattern::never).pattern;
}

TEST(RedrawnPattern, comes_where_the_drawing_has_changed_and_stays_elsewhere) {
    const ScratchFolder folder;
    const pattern::ShapePattern shown = found(folder);
    EXPECT_TRUE(writePng(folder / "guide.png", drawing(true)));
    const RedrawnPattern redrawn = valueOf(RedrawnPattern::of(shown));
    EXPECT_LT(redrawn.toneAfter, redrawn.toneBefore);
    const auto onTheRight = [](const pattern::ShapePattern& pattern) {
        return std::ranges::count_if(pattern.instances, [](const auto& instance) { return instance.centre.x > 210 / 180.0; });
    };
    EXPECT_GT(onTheRight(*redrawn.source.pattern), onTheRight(shown));
    EXPECT_LT(redrawn.removed + redrawn.changed, shown.instances.size() / 2) << "most stay";
    EXPECT_NE(redrawn.source.motion, nullptr) << "it sways";
}

TEST(RedrawnPattern, of_another_drawing_altogether_is_refused_with_advice) {
    const ScratchFolder folder;
    pattern::ShapePattern shown = found(folder);
    const auto refusal = [&] {
        const auto redrawn = RedrawnPattern::of(shown);
        return redrawn ? "" : folder.relative(redrawn.error().message());
    };
    EXPECT_TRUE(writePng(folder / "guide.png", drawing(false, 200)));
    EXPECT_EQ(refusal(),
              "guide.png: the drawing has another shape than the pattern; 'fantascope pattern' makes another pattern of it");
    EXPECT_TRUE(writePng(folder / "guide.png", drawing(true)));
    shown.compare = pattern::CompareSpace::Stored;
    EXPECT_THAT(refusal(), HasSubstr("was not compared in light"));
    folder.file("guide.png", "no picture");
    EXPECT_THAT(refusal(), HasSubstr("guide.png"));
}

}  // namespace
}  // namespace fantascope::app
