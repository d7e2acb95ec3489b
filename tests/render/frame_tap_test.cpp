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
    FrameReader& reader = tap.addReader();
    ASSERT_TRUE(output.sink().makeCurrent());
    tap.capture(output.sink().framebuffer(), std::chrono::seconds(5));
    const Shown shown = *output.sink().present();
    tap.publish(shown);
    const ShownFrame* const frame = reader.next(shown.at);
    ASSERT_NE(frame, nullptr);
    EXPECT_EQ(frame->output, 3u);
    EXPECT_EQ(frame->showTime, std::chrono::seconds(5));
    EXPECT_EQ(frame->shown.refresh, shown.refresh);
    EXPECT_EQ(frame->shown.at, tickTime(1, 30));
}

// The copy is of the moment of capture(), although it is fetched later.
// Example failure: the next frame is drawn over it before it is read.
TEST(FrameTap, captures_the_frame_before_the_next_one_is_drawn) {
    DrawnOutput output = whiteSquareAtTheTopLeft();
    output.frame({{0, 1}});
    FrameTap tap(0, kSize);
    FrameReader& reader = tap.addReader();
    tap.capture(output.sink().framebuffer(), Time::zero());
    output.frame(std::vector<show::LayerState>{});
    tap.publish({});
    const ShownFrame* const frame = reader.next(Time::zero());
    ASSERT_NE(frame, nullptr);
    EXPECT_EQ(frame->image.at(2, 2), (Rgba8{255, 255, 255, 255}));
}

// The display holds a finished frame until its refresh.
// Example failure: the wall shows a frame up to a refresh before the projector does.
TEST(FrameTap, shows_no_frame_before_its_refresh) {
    DrawnOutput output = whiteSquareAtTheTopLeft();
    FrameReader& reader = output.tap().addReader();
    output.frame({{0, 1}}, std::chrono::seconds(1));
    const Time visible = tickTime(1, 30);
    EXPECT_EQ(reader.next(visible - Time(1)), nullptr);
    ASSERT_NE(reader.next(visible), nullptr);
    EXPECT_EQ(reader.next(visible), nullptr) << "each frame once";
}

TEST(FrameTap, gives_every_reader_all_frames_in_order) {
    DrawnOutput output = whiteSquareAtTheTopLeft();
    FrameReader& prompt = output.tap().addReader();
    FrameReader& slow = output.tap().addReader();
    const auto expectFrame = [](FrameReader& reader, int number, const RgbaImage& image) {
        const ShownFrame* const frame = reader.next(Time::max());
        ASSERT_NE(frame, nullptr);
        EXPECT_EQ(frame->showTime, std::chrono::seconds(number));
        EXPECT_EQ(frame->shown.refresh, number);
        EXPECT_EQ(frame->image, image);
    };
    EXPECT_EQ(prompt.next(Time::max()), nullptr);
    const RgbaImage first = output.frame({{0, 1}}, std::chrono::seconds(1));
    expectFrame(prompt, 1, first);
    const RgbaImage second = output.frame({{0, 0.25f}}, std::chrono::seconds(2));
    expectFrame(prompt, 2, second);
    expectFrame(slow, 1, first);
    expectFrame(slow, 2, second);
    EXPECT_EQ(slow.next(Time::max()), nullptr);
}

// Example failure: a recorder that the machine holds up stops the show, or its frames change while it reads them.
TEST(FrameTap, goes_on_without_a_reader_that_does_not_read) {
    DrawnOutput output = whiteSquareAtTheTopLeft();
    FrameReader& stalled = output.tap().addReader();
    const RgbaImage first = output.frame({{0, 1}}, std::chrono::seconds(1));
    const ShownFrame* const held = stalled.next(Time::max());
    for (int number = 2; number < 20; ++number)
        output.frame({{0, 1.0f / static_cast<float>(number)}}, std::chrono::seconds(number));
    ASSERT_NE(held, nullptr);
    EXPECT_EQ(held->image, first);
    std::vector<std::int64_t> rest;
    while (const ShownFrame* const frame = stalled.next(Time::max())) rest.push_back(frame->shown.refresh);
    EXPECT_THAT(rest, testing::ElementsAre(2, 3, 4));
}

}  // namespace
}  // namespace fantascope::render
