#include "render/frame_tap.h"

#include "render/scene.h"

#include "allocations.h"
#include "core/geometry.h"

#include <epoxy/gl.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

namespace fantascope::render {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr glm::ivec2 kSize{64, 36};
constexpr double kEveryFrame = std::numeric_limits<double>::infinity(), kOnlyAsked = 0;

DrawnOutput whiteSquareAtTheTopLeft() {
    return {kSize, rectangleCorners(kSize.x, kSize.y), {resting(squareAt({0, 0}, 0.7, glm::vec3(1)))}};
}

// Replaces an OpenGL function for as long as it exists.
template <class Function>
class Replaced {
public:
    Replaced(Function& function, Function by) : function_(function), original_(std::exchange(function, by)) {}
    ~Replaced() { function_ = original_; }
    Replaced(const Replaced&) = delete;
    Replaced& operator=(const Replaced&) = delete;

private:
    Function& function_;
    Function original_;
};

int readbacks = 0;
PFNGLREADPIXELSPROC readPixels = nullptr;
void countedReadPixels(GLint x, GLint y, GLsizei width, GLsizei height, GLenum format, GLenum type, void* pixels) {
    ++readbacks;
    readPixels(x, y, width, height, format, type, pixels);
}

// A tap whose frames carry their number as a colour, on a display with a latency that the test
// sets.
class TapTest : public testing::Test {
protected:
    TapTest() : display_(whiteSquareAtTheTopLeft()) {
        display_.frame({{0, 1}});  // libepoxy resolves functions at their first call
        readPixels = epoxy_glReadPixels;
        counting_.emplace(epoxy_glReadPixels, countedReadPixels);
        readbacks = 0;
    }

    static Rgba8 colourOf(Time showTime) {
        const std::int64_t number = tickAt(showTime, 30);
        return {static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(number >> 8), 77, 255};
    }
    void draw(Time showTime) {
        const Rgba8 colour = colourOf(showTime);
        const float values[] = {colour.r / 255.0f, colour.g / 255.0f, colour.b / 255.0f, 1};
        glDisable(GL_FRAMEBUFFER_SRGB);
        glClearNamedFramebufferfv(display_.sink().framebuffer(), GL_COLOR, 0, values);
    }
    // Frame `number` at 30 Hz, visible at its show time.
    void frame(std::int64_t number) {
        const Time showTime = tickTime(number, 30);
        draw(showTime);
        tap_.capture(display_.sink().framebuffer(), showTime);
        glFinish();
        tap_.publish({number, showTime});
    }
    // Checks that a reader's frame is whole and returns its number; -1: no frame.
    static std::int64_t numberOf(const ShownFrame* frame) {
        if (frame == nullptr) return -1;
        const auto isIts = [&](Rgba8 pixel) { return pixel == colourOf(frame->showTime); };
        EXPECT_TRUE(std::ranges::all_of(frame->image.pixels(), isIts)) << frame->shown.refresh;
        return frame->shown.refresh;
    }
    static std::vector<std::int64_t> all(FrameReader& reader, Time now = Time::max()) {
        std::vector<std::int64_t> numbers;
        while (const ShownFrame* const frame = reader.next(now)) numbers.push_back(numberOf(frame));
        return numbers;
    }

    DrawnOutput display_;
    FrameTap tap_{3, kSize};
    std::optional<Replaced<PFNGLREADPIXELSPROC>> counting_;
};

// Example failure: OpenGL's bottom row comes first, so the simulated wall is upside down.
TEST(FrameTap, gives_the_frame_with_its_top_row_first) {
    DrawnOutput output = whiteSquareAtTheTopLeft();
    const RgbaImage& image = output.frame({{0, 1}});
    EXPECT_EQ(image.at(2, 2), (Rgba8{255, 255, 255, 255}));
    EXPECT_EQ(image.at(2, kSize.y - 3), (Rgba8{0, 0, 0, 255}));
    EXPECT_EQ(image.at(kSize.x - 3, 2), (Rgba8{0, 0, 0, 255}));
}

TEST_F(TapTest, says_what_was_shown_where_and_when) {
    FrameReader& reader = tap_.addQueue();
    tap_.capture(display_.sink().framebuffer(), 5s);
    ASSERT_TRUE(display_.sink().finish());  // else the copy may still be on its way
    const Shown shown = *display_.sink().present();
    tap_.publish(shown);
    const ShownFrame* const frame = reader.next(shown.at);
    ASSERT_NE(frame, nullptr);
    EXPECT_EQ(frame->output, 3u);
    EXPECT_EQ(frame->showTime, 5s);
    EXPECT_EQ(frame->shown.refresh, shown.refresh);
    EXPECT_EQ(frame->shown.at, shown.at);
}

// The copy is of the moment of capture(), although it is read later.
// Example failure: the next frame is drawn over it before it is read.
TEST_F(TapTest, captures_the_frame_before_the_next_one_is_drawn) {
    FrameReader& reader = tap_.addQueue();
    draw(1s);
    tap_.capture(display_.sink().framebuffer(), 1s);
    draw(2s);
    tap_.publish({30, 1s});
    tap_.finish();
    EXPECT_EQ(numberOf(reader.next(1s)), 30);
}

// A display holds a finished frame until its refresh.
// Example failure: the simulated wall shows a frame up to one refresh before the projector does.
TEST_F(TapTest, shows_no_reader_a_frame_before_its_refresh) {
    FrameReader& queue = tap_.addQueue();
    FrameReader& newest = tap_.addNewest(kEveryFrame);
    frame(1);
    const Time visible = tickTime(1, 30);
    for (FrameReader* reader : {&queue, &newest}) {
        EXPECT_EQ(reader->next(visible - Time(1)), nullptr);
        EXPECT_EQ(numberOf(reader->next(visible)), 1);
        EXPECT_EQ(reader->next(visible), nullptr) << "each frame once";
    }
}

// While the display holds a finished frame, people see the one before it.
// Example failure: the slot holds only the future frame, and the reader gets nothing although
// something is shown.
TEST_F(TapTest, the_newest_frame_is_the_one_before_while_the_display_still_holds_the_next) {
    FrameReader& newest = tap_.addNewest(kEveryFrame);
    for (int number = 1; number <= 10; ++number) frame(number);
    const Time held = tickTime(10, 30);
    EXPECT_EQ(numberOf(newest.next(held - Time(1))), 9);
    EXPECT_EQ(newest.next(held - Time(1)), nullptr);
    EXPECT_EQ(numberOf(newest.next(held)), 10) << "although no further frame has come";
    frame(11);
    EXPECT_EQ(newest.next(held), nullptr) << "it was taken before";
    EXPECT_EQ(numberOf(newest.next(tickTime(11, 30))), 11);
}

TEST_F(TapTest, a_queue_gives_all_frames_in_order_and_a_slot_the_newest) {
    FrameReader& prompt = tap_.addQueue();
    FrameReader& slow = tap_.addQueue();
    FrameReader& newest = tap_.addNewest(kEveryFrame);
    for (int number = 1; number <= 3; ++number) {
        frame(number);
        EXPECT_THAT(all(prompt), ElementsAre(number));
    }
    EXPECT_THAT(all(slow), ElementsAre(1, 2, 3));
    EXPECT_THAT(all(newest), ElementsAre(3));
    EXPECT_THAT(all(newest), IsEmpty());
}

// Example failure: a recorder that is held up stops the show, or its frames change while it reads
// them.
TEST_F(TapTest, goes_on_without_readers_that_do_not_read) {
    FrameReader& stalled = tap_.addQueue();
    FrameReader& asleep = tap_.addNewest(kEveryFrame);
    FrameReader& awake = tap_.addNewest(kEveryFrame);
    frame(1);
    const ShownFrame *const held = stalled.next(Time::max()), *const seen = asleep.next(Time::max());
    for (int number = 2; number < 20; ++number) {
        frame(number);
        EXPECT_EQ(numberOf(awake.next(Time::max())), number);
    }
    EXPECT_EQ(numberOf(held), 1);
    EXPECT_EQ(numberOf(seen), 1);
    EXPECT_THAT(all(stalled), ElementsAre(2, 3, 4, 5));
    EXPECT_THAT(all(asleep), ElementsAre(19));
}

// Example failure: a video has gaps that are not reported.
TEST_F(TapTest, a_queue_counts_every_frame_that_it_leaves_out) {
    FrameQueue& queue = tap_.addQueue(10);
    ASSERT_TRUE(tap_.prepare());
    for (int number = 1; number <= 25; ++number) frame(number);
    EXPECT_THAT(all(queue), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9, 10));
    EXPECT_EQ(queue.missed(), 15);
    for (int number = 26; number <= 60; ++number) {
        frame(number);
        EXPECT_EQ(queue.nextAt(Time::max()), tickTime(number, 30));
        EXPECT_THAT(all(queue), ElementsAre(number));
    }
    EXPECT_EQ(queue.nextAt(Time::max()), std::nullopt);
    EXPECT_EQ(queue.missed(), 15);
}

TEST_F(TapTest, a_frame_is_read_back_once_however_many_want_it_and_not_at_all_for_nobody) {
    for (int number = 1; number <= 5; ++number) frame(number);
    EXPECT_EQ(readbacks, 0) << "no reader";
    FrameTap tap(0, kSize);
    NewestFrame& asks = tap.addNewest(kOnlyAsked);
    const auto captured = [&](int number) {
        tap.capture(display_.sink().framebuffer(), tickTime(number, 30));
        tap.publish({number, tickTime(number, 30)});
        tap.finish();
    };
    for (int number = 1; number <= 5; ++number) captured(number);
    EXPECT_EQ(readbacks, 0) << "a reader that has not asked";
    asks.ask(tickTime(6, 30));
    for (int number = 6; number <= 10; ++number) captured(number);
    EXPECT_EQ(readbacks, 1) << "one that has";

    FrameTap crowded(0, kSize);
    for (int i = 0; i < 3; ++i) {
        crowded.addQueue();
        crowded.addNewest(kEveryFrame);
    }
    readbacks = 0;
    for (int number = 1; number <= 20; ++number) {
        crowded.capture(display_.sink().framebuffer(), tickTime(number, 30));
        crowded.publish({number, tickTime(number, 30)});
        crowded.finish();
        EXPECT_EQ(readbacks, number);
    }
}

TEST_F(TapTest, readers_get_frames_at_their_own_rates) {
    FrameReader& fast = tap_.addNewest(10);
    FrameReader& slow = tap_.addNewest(4);
    std::vector<std::int64_t> ofFast, ofSlow;
    for (int number = 0; number <= 30; ++number) {
        frame(number);
        for (const std::int64_t seen : all(fast)) ofFast.push_back(seen);
        for (const std::int64_t seen : all(slow)) ofSlow.push_back(seen);
    }
    EXPECT_THAT(ofFast, ElementsAre(0, 3, 6, 9, 12, 15, 18, 21, 24, 27, 30));
    EXPECT_THAT(ofSlow, ElementsAre(0, 8, 16, 24))
        << "no frame is exactly a quarter of a second after the first, so the next one is taken";
    EXPECT_EQ(readbacks, 13) << "once where both want it";
}

TEST_F(TapTest, one_that_asks_gets_one_frame_the_first_of_that_moment) {
    NewestFrame& reader = tap_.addNewest(kOnlyAsked);
    tap_.addQueue();  // so that every frame is read back
    reader.ask(tickTime(5, 30));
    for (int number = 1; number <= 9; ++number) frame(number);
    EXPECT_THAT(all(reader), ElementsAre(5));
    for (int number = 10; number <= 19; ++number) frame(number);
    EXPECT_THAT(all(reader), IsEmpty());
    reader.ask(Time::zero());
    frame(20);
    frame(21);
    EXPECT_THAT(all(reader), ElementsAre(20)) << "a past moment means the next frame";
}

// Example failure: an operator who asks for a picture while a projector is unplugged never gets
// one.
TEST_F(TapTest, a_frame_that_was_not_shown_is_given_to_nobody_and_the_next_one_counts) {
    NewestFrame& asks = tap_.addNewest(kOnlyAsked);
    FrameReader& sometimes = tap_.addNewest(1);
    asks.ask(Time::zero());
    draw(tickTime(1, 30));
    tap_.capture(display_.sink().framebuffer(), tickTime(1, 30));  // present() fails: the cable was pulled
    frame(2);
    EXPECT_THAT(all(asks), ElementsAre(2));
    EXPECT_THAT(all(sometimes), ElementsAre(2));
}

// Makes the GPU as slow as the test wants.
bool isBehind = false;
PFNGLCLIENTWAITSYNCPROC clientWaitSync = nullptr;
GLenum slowClientWaitSync(GLsync sync, GLbitfield flags, GLuint64 timeout) {
    if (isBehind && timeout == 0) return GL_TIMEOUT_EXPIRED;
    EXPECT_FALSE(isBehind) << "a GPU that is behind is not waited for";
    return clientWaitSync(sync, flags, timeout);
}

// Example failure: the render thread waits for a copy, and the show stutters because of a reader.
TEST_F(TapTest, a_copy_that_is_not_done_is_handed_out_with_a_later_frame) {
    clientWaitSync = epoxy_glClientWaitSync;
    const Replaced<PFNGLCLIENTWAITSYNCPROC> slow(epoxy_glClientWaitSync, slowClientWaitSync);
    FrameQueue& queue = tap_.addQueue();
    FrameReader& newest = tap_.addNewest(kEveryFrame);
    frame(1);
    isBehind = true;
    frame(2);
    frame(3);
    EXPECT_THAT(all(queue), ElementsAre(1));
    EXPECT_THAT(all(newest), ElementsAre(1));
    isBehind = false;
    frame(4);
    EXPECT_THAT(all(queue), ElementsAre(2, 3, 4)) << "none was dropped";
    EXPECT_THAT(all(newest), ElementsAre(4));

    isBehind = true;
    for (int number = 5; number <= 20; ++number) frame(number);
    EXPECT_THAT(all(queue), IsEmpty());
    isBehind = false;
    tap_.finish();
    EXPECT_THAT(all(queue), ElementsAre(5, 6, 7)) << "a GPU that does not keep up does not accumulate copies";
    EXPECT_EQ(queue.missed(), 13);
    frame(21);
    EXPECT_THAT(all(queue), ElementsAre(21));
}

TEST_F(TapTest, allocates_nothing_on_the_render_thread_once_it_is_prepared) {
    FrameReader& queue = tap_.addQueue();
    FrameReader& newest = tap_.addNewest(kEveryFrame);
    NewestFrame& asks = tap_.addNewest(kOnlyAsked);
    FrameReader& sleeps = tap_.addNewest(12);
    ASSERT_TRUE(tap_.prepare());
    std::int64_t allocated = 0;
    std::size_t read = 0;
    for (int number = 1; number <= 60; ++number) {
        if (number % 7 == 0) asks.ask(tickTime(number, 30));
        const std::int64_t before = allocationsSoFar();
        frame(number);
        if (number % 3 == 0) queue.next(Time::max());
        newest.next(Time::max());
        allocated += allocationsSoFar() - before;
        read += all(asks).size();
    }
    EXPECT_EQ(allocated, 0);
    EXPECT_EQ(read, 8u);
    EXPECT_EQ(all(sleeps).size(), 1u);
}

// Real threads, above all for the thread sanitizer: a reader gets only whole frames, in rising
// order.
TEST_F(TapTest, readers_on_threads_of_their_own_get_whole_frames_and_the_newest_in_the_end) {
    constexpr std::int64_t kFrames = 600;
    struct Reading {
        FrameReader& reader;
        std::int64_t newest = -1, frames = 0;
    };
    Reading readings[] = {{tap_.addQueue()}, {tap_.addNewest(kEveryFrame)}, {tap_.addNewest(kEveryFrame)}, {tap_.addNewest(9)}};
    std::atomic<std::int64_t> shown = -1;
    {
        std::vector<std::jthread> threads;
        for (Reading& reading : readings)
            threads.emplace_back([&] {
                for (bool last = false; !last;) {
                    last = shown == kFrames;  // read before what may be the last next()
                    const Time now = tickTime(std::max<std::int64_t>(shown, 0), 30);
                    while (const ShownFrame* const frame = reading.reader.next(now)) {
                        EXPECT_LE(frame->shown.at, now);
                        EXPECT_GT(numberOf(frame), reading.newest);
                        reading.newest = frame->shown.refresh;
                        ++reading.frames;
                    }
                    std::this_thread::yield();
                }
            });
        for (std::int64_t number = 0; number <= kFrames; ++number) {
            frame(number);
            shown = number;
        }
    }
    for (const Reading& reading : readings) EXPECT_GT(reading.frames, 0);
    EXPECT_EQ(readings[1].newest, kFrames);
    EXPECT_EQ(readings[2].newest, kFrames);
    EXPECT_EQ(readings[3].newest, 600) << "a ninth of a second is four frames, and 600 is a multiple of four";
}

}  // namespace
}  // namespace fantascope::render
