#include "drivers/display/glfw.h"
#include "drivers/onlooker.h"
#include "drivers/virtual_x_server.h"

#include <epoxy/gl.h>
#include <gmock/gmock.h>

#include <memory>
#include <string>

namespace fantascope::drivers {
namespace {

using testing::HasSubstr;

class GlfwDisplayTest : public testing::Test {
protected:
    void SetUp() override {
        auto server = VirtualXServer::start();
        ASSERT_TRUE(server) << server.error().message();
        server_ = std::move(server).value();
    }
    std::unique_ptr<DisplaySink> open(const std::string& name, const std::string& options = "", glm::ivec2 size = {64, 36}) {
        return GlfwDisplay::open(*ConfigNode::parse("driver: glfw\n" + options, "site.yaml"), {name, size, 30}, {clock_}).value();
    }
    std::unique_ptr<VirtualXServer> server_;
    ManualClock clock_;
};

// The upper half of the picture is light, half of the light that is.
void drawHalf(DisplaySink& sink) {
    glEnable(GL_FRAMEBUFFER_SRGB);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, sink.framebuffer());
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glEnable(GL_SCISSOR_TEST);
    glScissor(0, sink.size().y / 2, sink.size().x, sink.size().y / 2);
    glClearColor(0.5f, 0.5f, 0.5f, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    glDisable(GL_SCISSOR_TEST);
}

// Example failure: stored values are encoded a second time on their way to the window, and the night is too bright.
TEST_F(GlfwDisplayTest, shows_on_the_screen_what_was_drawn) {
    const auto sink = open("left");
    ASSERT_TRUE(sink->makeCurrent()) << sink->status().detail;
    drawHalf(*sink);
    ASSERT_TRUE(sink->present(true));
    Onlooker onlooker;
    EXPECT_NEAR(onlooker.colourAt("left", 10, 5) & 0xff, 188, 1);
    EXPECT_EQ(onlooker.colourAt("left", 10, 30), 0u);
}

TEST_F(GlfwDisplayTest, is_absent_after_somebody_closed_its_window_and_opens_it_again) {
    const auto left = open("left"), right = open("right");
    Onlooker onlooker;
    onlooker.close("left");
    // The click travels by the server; it is there after a few looks, and certainly after many.
    for (int looks = 0; looks < 100'000 && left->makeCurrent(); ++looks) {
    }
    EXPECT_EQ(left->status().state, DeviceState::Absent);
    EXPECT_THAT(left->status().detail, HasSubstr("closed"));
    EXPECT_EQ(left->status().losses, 1);
    EXPECT_FALSE(onlooker.isVisible("left"));
    EXPECT_TRUE(right->makeCurrent());
    clock_.advance(GlfwDisplay::kReopenAfter);
    EXPECT_TRUE(left->makeCurrent());
    EXPECT_EQ(left->status().state, DeviceState::Running);
    EXPECT_TRUE(onlooker.isVisible("left"));
}

// Xvfb has one monitor; GLFW calls it "screen".
TEST_F(GlfwDisplayTest, fills_the_named_monitor) {
    const auto sink = open("left", "monitor: screen\n", {1280, 720});
    ASSERT_TRUE(sink->makeCurrent()) << sink->status().detail;
    EXPECT_EQ(Onlooker().sizeOf("left"), glm::ivec2(1280, 720));
}

TEST_F(GlfwDisplayTest, is_absent_without_its_monitor_and_says_which_there_are) {
    const auto sink = open("left", "monitor: HDMI-7\n", {1280, 720});
    EXPECT_EQ(sink->status().state, DeviceState::Absent);
    EXPECT_EQ(sink->status().losses, 0);
    EXPECT_EQ(sink->status().detail, "monitor 'HDMI-7' is not connected; connected: screen");
    EXPECT_THAT(open("right", "monitor: screen\n", {123, 45})->status().detail,
                HasSubstr("'screen' cannot show 123 x 45 pixels"));
}

// The projectors' machine may start before its window system.
TEST_F(GlfwDisplayTest, waits_for_a_window_system) {
    server_.reset();
    const auto sink = open("left");
    EXPECT_EQ(sink->status().state, DeviceState::Absent);
    EXPECT_THAT(sink->status().detail, HasSubstr("no window system"));
    SetUp();
    EXPECT_FALSE(sink->makeCurrent()) << "it tries again after a while, not in every frame";
    clock_.advance(std::chrono::seconds(30));
    EXPECT_TRUE(sink->makeCurrent()) << sink->status().detail;
    EXPECT_TRUE(sink->present(true));
    EXPECT_EQ(sink->status().losses, 0);
}

TEST(GlfwDisplay, refuses_an_unknown_key) {
    ManualClock clock;
    const auto sink =
        GlfwDisplay::open(*ConfigNode::parse("driver: glfw\nmonitr: HDMI-1\n", "site.yaml"), {"left", {64, 36}, 30}, {clock});
    ASSERT_FALSE(sink);
    EXPECT_EQ(sink.error().message(), "site.yaml:2:1: monitr: unknown key (did you mean 'monitor'?)");
}

}  // namespace
}  // namespace fantascope::drivers
