#include "render/frame_tap.h"

#include "render/scene.h"

#include "core/geometry.h"

#include <gmock/gmock.h>

namespace fantascope::render {
namespace {

constexpr glm::ivec2 kSize{64, 36};

DrawnOutput whiteSquareAtTheTopLeft() {
    return {kSize, rectangleCorners(kSize.x, kSize.y), {resting(squareAt({0, 0}, 0.7, glm::vec3(1)))}};
}

// Example failure: OpenGL's bottom row comes first, and the site's wall is upside down.
TEST(FrameTap, gives_the_frame_with_its_top_row_first) {
    DrawnOutput output = whiteSquareAtTheTopLeft();
    const RgbaImage& image = output.frame({{0, 1}});
    EXPECT_EQ(image.at(2, 2), (Rgba8{255, 255, 255, 255}));
    EXPECT_EQ(image.at(2, kSize.y - 3), (Rgba8{0, 0, 0, 255}));
    EXPECT_EQ(image.at(kSize.x - 3, 2), (Rgba8{0, 0, 0, 255}));
}

TEST(FrameTap, says_what_was_shown_where_and_when) {
    DrawnOutput output = whiteSquareAtTheTopLeft();
    FrameTap tap(3, kSize);
    LatestValue<ShownFrame>& reader = tap.addReader();
    ASSERT_TRUE(output.sink().makeCurrent());
    tap.capture(output.sink().framebuffer(), std::chrono::seconds(5));
    const Shown shown = *output.sink().present(true);
    tap.publish(shown);
    ASSERT_TRUE(reader.update());
    EXPECT_EQ(reader.value().output, 3u);
    EXPECT_EQ(reader.value().showTime, std::chrono::seconds(5));
    EXPECT_EQ(reader.value().shown.refresh, shown.refresh);
    EXPECT_EQ(reader.value().shown.at, tickTime(1, 30));
}

// The copy is of the moment of capture(), although it is fetched later.
// Example failure: the next frame is drawn over it before it is read.
TEST(FrameTap, captures_the_frame_before_the_next_one_is_drawn) {
    DrawnOutput output = whiteSquareAtTheTopLeft();
    output.frame({{0, 1}});
    FrameTap tap(0, kSize);
    LatestValue<ShownFrame>& reader = tap.addReader();
    tap.capture(output.sink().framebuffer(), Time::zero());
    output.frame(std::vector<show::LayerState>{});
    tap.publish({});
    ASSERT_TRUE(reader.update());
    EXPECT_EQ(reader.value().image.at(2, 2), (Rgba8{255, 255, 255, 255}));
}

TEST(FrameTap, gives_every_reader_the_newest_frame_in_its_own_slot) {
    DrawnOutput output = whiteSquareAtTheTopLeft();
    LatestValue<ShownFrame>& prompt = output.tap().addReader();
    LatestValue<ShownFrame>& slow = output.tap().addReader();
    EXPECT_FALSE(prompt.update());
    output.frame({{0, 1}}, std::chrono::seconds(1));
    ASSERT_TRUE(prompt.update());
    EXPECT_EQ(prompt.value().image.at(2, 2), (Rgba8{255, 255, 255, 255}));
    const RgbaImage second = output.frame({{0, 0.25f}}, std::chrono::seconds(2));
    for (LatestValue<ShownFrame>* slot : {&prompt, &slow}) {
        ASSERT_TRUE(slot->update());
        EXPECT_EQ(slot->value().showTime, std::chrono::seconds(2));
        EXPECT_EQ(slot->value().shown.refresh, 2);
        EXPECT_EQ(slot->value().image, second);
        EXPECT_FALSE(slot->update());
    }
}

}  // namespace
}  // namespace fantascope::render
