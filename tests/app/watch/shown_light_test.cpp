// The light that outputs gave when the camera exposed a picture, and whether to wait for it.

#include "app/watch/shown_light.h"

#include "vision/watched_wall.h"

#include <gmock/gmock.h>

#include <deque>
#include <utility>

namespace fantascope::app {
namespace {

using std::chrono::milliseconds;

// Two outputs on one wall, whose frames the test gives to the watch.
class ShownLightTest : public testing::Test {
protected:
    struct Frames {
        std::deque<render::ShownFrame> come{};
        render::ShownFrame given{};
    };
    void give(std::size_t output, Time visible) {
        frames_[output].come.push_back({output, visible, {0, visible, visible, {}}, RgbaImage(size_.x, size_.y)});
    }
    ShownLight::Output outputOf(std::size_t i) {
        const auto next = [this, i](Time) -> const render::ShownFrame* {
            if (frames_[i].come.empty()) return nullptr;
            frames_[i].given = std::move(frames_[i].come.front());
            frames_[i].come.pop_front();
            return &frames_[i].given;
        };
        return {{next, [this](Time) { ++asked_; }}, kRate};
    }
    // A picture that was exposed every 200 ms; both outputs gave their frames until `last`.
    void runUntil(Time last) {
        for (; now_ <= last; now_ += kPeriod) {
            give(0, now_ - kFrame / 2);
            give(1, now_ - kFrame / 2);
            light_.exposed(now_, kPeriod);
            light_.tick(now_ + milliseconds(120));
        }
    }

    static constexpr double kRate = 5;
    static constexpr Time kFrame = milliseconds(200), kPeriod = milliseconds(200);
    const vision::ProjectedWall place_ = vision::brickWall();
    const glm::ivec2 size_ = place_.projector.size;
    const vision::WallWatch wall_{{vision::watchedOn(place_), vision::watchedOn(place_)}, place_.camera.size};
    std::array<Frames, 2> frames_{};
    int asked_ = 0;
    Time now_{};
    ShownLight light_{{outputOf(0), outputOf(1)}, wall_, show::ShowClock()};
};

// Example failure: on a slow display a moment has the light of the frame before.
TEST_F(ShownLightTest, is_that_of_the_frame_that_was_visible) {
    runUntil(std::chrono::seconds(2));
    EXPECT_EQ(light_.at(0, milliseconds(1930)), light_.at(0, milliseconds(2070)));
    EXPECT_NE(light_.at(0, milliseconds(2000)), nullptr);
    EXPECT_NE(light_.at(0, milliseconds(1600)), light_.at(0, milliseconds(2000)));
    EXPECT_EQ(light_.at(0, milliseconds(2200)), nullptr);
    EXPECT_FALSE(light_.isComing(milliseconds(2000), milliseconds(2150))) << "it is there";
    EXPECT_GT(asked_, 0);
}

TEST_F(ShownLightTest, is_waited_for_until_all_outputs_gave_it) {
    runUntil(std::chrono::seconds(2));
    const Time moment = milliseconds(2200);
    EXPECT_TRUE(light_.isComing(moment, milliseconds(2250)));
    give(0, moment - kFrame / 2);
    light_.tick(milliseconds(2400));
    EXPECT_TRUE(light_.isComing(moment, milliseconds(2400))) << "the other output's";
    give(1, moment - kFrame / 2);
    light_.tick(milliseconds(2500));
    EXPECT_FALSE(light_.isComing(moment, milliseconds(2500)));
    EXPECT_NE(light_.at(1, moment), nullptr);
}

// Example failure: an output that shows nothing any more holds up the watch of the others.
TEST_F(ShownLightTest, is_not_waited_for_for_ever) {
    runUntil(std::chrono::seconds(2));
    EXPECT_FALSE(light_.isComing(milliseconds(2200), milliseconds(3300))) << "too long";
    for (; now_ <= std::chrono::seconds(8); now_ += kPeriod) {
        give(0, now_ - kFrame / 2);
        light_.exposed(now_, kPeriod);
        light_.tick(now_ + milliseconds(120));
    }
    EXPECT_NE(light_.at(0, milliseconds(8000)), nullptr);
    EXPECT_FALSE(light_.isComing(milliseconds(8000), milliseconds(8100))) << "the other output has gone";
}

// Example failure: a frame that was skipped is waited for, though a newer one has come.
TEST_F(ShownLightTest, is_not_waited_for_once_it_has_passed) {
    runUntil(std::chrono::seconds(2));
    for (const std::size_t output : {0, 1}) give(output, milliseconds(2600));
    light_.tick(milliseconds(2700));
    EXPECT_EQ(light_.at(0, milliseconds(2200)), nullptr);
    EXPECT_FALSE(light_.isComing(milliseconds(2200), milliseconds(2700)));
}

}  // namespace
}  // namespace fantascope::app
