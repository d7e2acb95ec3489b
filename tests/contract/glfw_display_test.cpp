// What a window adds to the promises of every display.

#include "drivers/display/glfw.h"

#include "contract/x_server.h"
#include "core/check.h"

#include <epoxy/gl.h>
#include <gmock/gmock.h>

#include <cstdlib>
#include <utility>

namespace fantascope::contract {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;

std::unique_ptr<DisplaySink> open(const std::string& options, glm::ivec2 size, Clock& clock) {
    auto sink = drivers::GlfwDisplay::open(*ConfigNode::parse(options, "site.yaml"), {"left", size, 30}, {clock});
    FANTASCOPE_CHECK(sink.has_value(), sink.error().message());
    return std::move(sink).value();
}

class GlfwDisplay : public testing::Test {
protected:
    void SetUp() override {
        auto server = XServer::start();
        ASSERT_TRUE(server) << server.error().message();
        server_ = std::move(server).value();
    }

    std::unique_ptr<XServer> server_;
    ManualClock clock_;
};

// All 256 stored values, in the picture's top row alone, so that a picture upside down is found out. A conversion there and back on
// the way to the window would move some by one, a single one nearly all.
TEST_F(GlfwDisplay, fills_its_monitor_with_the_stored_values) {
    const auto sink = open("{driver: glfw, monitor: screen}", {1280, 720}, clock_);
    ASSERT_TRUE(sink->makeCurrent()) << sink->status().detail;
    glBindFramebuffer(GL_FRAMEBUFFER, sink->framebuffer());
    glDisable(GL_FRAMEBUFFER_SRGB);  // what is drawn now is stored as it is
    const GLfloat black[] = {0, 0, 0, 1};
    glClearBufferfv(GL_COLOR, 0, black);
    glEnable(GL_SCISSOR_TEST);
    for (int value = 0; value < 256; ++value) {
        const GLfloat colour[] = {float(value) / 255, 0, float(255 - value) / 255, 1};
        glScissor(value, 719, 1, 1);
        glClearBufferfv(GL_COLOR, 0, colour);
    }
    glDisable(GL_SCISSOR_TEST);
    glEnable(GL_FRAMEBUFFER_SRGB);  // as a renderer leaves it
    ASSERT_TRUE(sink->finish());
    ASSERT_TRUE(sink->present());
    EXPECT_TRUE(glIsEnabled(GL_FRAMEBUFFER_SRGB)) << "the renderer's state is changed";

    const auto top = server_->row(0);
    for (int value = 0; value < 256; ++value) EXPECT_THAT(top[value], ElementsAre(value, 0, 255 - value)) << value;
    EXPECT_THAT(server_->row(1), Each(ElementsAre(0, 0, 0)));
}

TEST_F(GlfwDisplay, is_absent_without_its_monitor_and_names_those_there_are) {
    const auto sink = open("{driver: glfw, monitor: HDMI-7}", {1280, 720}, clock_);
    EXPECT_EQ(sink->status().state, DeviceState::Absent);
    EXPECT_THAT(sink->status().detail, HasSubstr("no monitor HDMI-7 (there is: screen (without EDID))"));
    EXPECT_FALSE(sink->present());
}

// Otherwise the picture would be scaled or cut and nobody would know.
TEST_F(GlfwDisplay, is_absent_on_a_monitor_without_a_mode_of_its_size) {
    const auto sink = open("{driver: glfw, monitor: screen}", {1000, 700}, clock_);
    EXPECT_THAT(sink->status().detail, HasSubstr("no mode of 1000 x 700"));
}

// Nobody could see both otherwise: where no window manager places them, two windows would lie on each other.
TEST_F(GlfwDisplay, stands_beside_the_windows_before_it) {
    const auto left = open("{driver: glfw}", {640, 36}, clock_), right = open("{driver: glfw}", {640, 36}, clock_),
               below = open("{driver: glfw}", {64, 20}, clock_);
    const auto show = [](DisplaySink& sink, float red) {
        ASSERT_TRUE(sink.makeCurrent());
        const GLfloat colour[] = {red, 0, 0, 1};
        glBindFramebuffer(GL_FRAMEBUFFER, sink.framebuffer());
        glDisable(GL_FRAMEBUFFER_SRGB);
        glClearBufferfv(GL_COLOR, 0, colour);
        ASSERT_TRUE(sink.finish());
        ASSERT_TRUE(sink.present());
    };
    show(*left, 0.2f);
    show(*right, 0.4f);
    show(*below, 0.6f);
    EXPECT_EQ(server_->row(0)[639][0], 51);
    EXPECT_EQ(server_->row(0)[640][0], 102);
    EXPECT_EQ(server_->row(35)[1279][0], 102);
    EXPECT_EQ(server_->row(36)[0][0], 153) << "the next row";
}

TEST_F(GlfwDisplay, stays_closed_when_somebody_closes_its_window) {
    const auto sink = open("{driver: glfw}", {64, 36}, clock_);
    ASSERT_TRUE(sink->present());
    ASSERT_TRUE(server_->hasWindow("left"));
    server_->closeWindow("left");
    // The request travels by the server: some frame's events tell of it, the next one's or a later one's.
    for (int frame = 0; frame < 100'000 && sink->presentWith(clock_.now()); ++frame) {
    }
    for (int second = 0; second < 3; ++second) {
        EXPECT_FALSE(sink->poll());
        EXPECT_FALSE(sink->present());
        clock_.advance(std::chrono::seconds(1));
    }
    EXPECT_EQ(sink->status().state, DeviceState::Absent);
    EXPECT_THAT(sink->status().detail, HasSubstr("start Fantascope again"));
    EXPECT_EQ(sink->status().losses, 1);
    EXPECT_FALSE(server_->hasWindow("left"));
}

// A technician's keyboard at the output itself. A key comes by the server: some frame's events tell of it.
TEST_F(GlfwDisplay, hears_the_keys_that_are_pressed_at_it) {
    const auto sink = open("{driver: glfw}", {64, 36}, clock_);
    ASSERT_TRUE(sink->present());
    for (const auto& [pressed, wanted] : {std::pair<std::string, Key>("y", {.letter = 'y'}),
                                          {"Left", {.name = Key::Name::Left}},
                                          {"Tab", {.name = Key::Name::Tab}},
                                          {"bracketright", {.letter = ']'}},
                                          {"space", {.letter = ' '}}}) {
        server_->pressKey("left", pressed);
        std::optional<ScreenEvent> event;
        for (int frame = 0; frame < 100'000 && !event; ++frame) {
            ASSERT_TRUE(sink->presentWith(clock_.now()));
            event = sink->pollEvent();
        }
        ASSERT_TRUE(event) << pressed;
        EXPECT_EQ(event->kind, ScreenEvent::Kind::KeyDown);
        EXPECT_EQ(event->key, wanted) << pressed;
    }
}

TEST_F(GlfwDisplay, waits_for_an_x_server_and_tries_once_a_second) {
    const std::string name = std::getenv("DISPLAY");
    ::unsetenv("DISPLAY");
    const auto sink = open("{driver: glfw}", {64, 36}, clock_);
    ::setenv("DISPLAY", name.c_str(), 1);
    EXPECT_EQ(sink->status().state, DeviceState::Absent);
    EXPECT_THAT(sink->status().detail, HasSubstr("set DISPLAY, or start an X server"));
    EXPECT_FALSE(sink->poll()) << "it tries again before a second is over";
    EXPECT_FALSE(sink->makeCurrent()) << "there is no OpenGL without an X server";
    clock_.advance(std::chrono::seconds(1));
    EXPECT_TRUE(sink->poll());
    EXPECT_TRUE(sink->makeCurrent());
    EXPECT_EQ(sink->status().state, DeviceState::Running);
    EXPECT_EQ(sink->status().losses, 0) << "what was never there was not lost";
}

TEST_F(GlfwDisplay, refuses_a_wrong_key) {
    const auto sink = drivers::GlfwDisplay::open(*ConfigNode::parse("{driver: glfw, monitr: a}", "site.yaml"), {}, {clock_});
    ASSERT_FALSE(sink);
    EXPECT_THAT(sink.error().message(), HasSubstr("monitor"));
}

}  // namespace
}  // namespace fantascope::contract
