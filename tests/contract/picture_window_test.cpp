#include "drivers/display/picture_window.h"

#include "drivers/registry.h"

#include "contract/eventually.h"
#include "contract/x_server.h"

#include <gmock/gmock.h>

#include <tuple>
#include <vector>

namespace fantascope::contract {
namespace {

class PictureWindow : public testing::Test {
protected:
    void SetUp() override {
        auto server = XServer::start();
        ASSERT_TRUE(server) << server.error().message();
        server_ = std::move(server).value();
        // As large as the screen, so that its pixels are the screen's.
        auto window = drivers::PictureWindow::open("work", {1280, 720});
        ASSERT_TRUE(window) << window.error().message();
        window_ = std::move(window).value();
    }
    // The pressed keys, up to the first of these.
    std::vector<char> keysUntil(char last) {
        std::vector<char> keys;
        while (keys.empty() || keys.back() != last)
            if (const auto key = window_->pollKey()) keys.push_back(*key);
        return keys;
    }

    const BrokenPipesIgnored ignored_;
    std::unique_ptr<XServer> server_;
    std::unique_ptr<drivers::PictureWindow> window_;
};

// White at the top, grey below, in the middle of a window that is wider. Example failure: upside
// down, or stretched.
TEST_F(PictureWindow, shows_a_picture_upright_between_black_bars) {
    GreyImage picture(72, 72, 0.4f);
    for (int y = 0; y < 36; ++y)
        for (int x = 0; x < 72; ++x) picture.at(x, y) = 1;
    for (int frame = 0; frame < 2; ++frame) {
        window_->show(picture);
        const auto above = server_->row(100), below = server_->row(600);
        for (const int x : {0, 279, 1000, 1279}) EXPECT_EQ(above[static_cast<std::size_t>(x)][0], 0) << x;
        for (const int x : {281, 640, 998}) {
            EXPECT_EQ(above[static_cast<std::size_t>(x)][1], 255) << x;
            EXPECT_EQ(below[static_cast<std::size_t>(x)][1], 102) << x;
        }
    }
}

TEST_F(PictureWindow, hears_keys_and_takes_its_closing_for_escape) {
    window_->show(GreyImage(16, 9));
    EXPECT_EQ(window_->pollKey(), std::nullopt);
    server_->pressKey("work", "space");
    server_->pressKey("work", "q");
    server_->pressKey("work", "Escape");
    EXPECT_THAT(keysUntil('\x1b'), testing::ElementsAre(' ', 'q', '\x1b'));
    server_->closeWindow("work");
    EXPECT_THAT(keysUntil('\x1b'), testing::ElementsAre('\x1b'));
    EXPECT_EQ(window_->pollKey(), std::nullopt);
}

// In pixels of the picture, which is scaled by ten and stands between black bars of 280 pixels.
TEST_F(PictureWindow, reports_keys_with_their_modifiers_and_the_pointer_on_the_picture) {
    using Kind = ScreenEvent::Kind;
    window_->show(RgbaImage(72, 72));
    const auto next = [&] {
        std::optional<ScreenEvent> event;
        eventually("an event comes", [&] { return (event = window_->pollEvent()).has_value(); });
        return *event;
    };
    EXPECT_EQ(next().at, glm::dvec2(36, 36)) << "the pointer is in the middle of the screen";
    EXPECT_FALSE(window_->pollEvent());
    using Held = XServer::Held;
    for (const auto& [name, key, held] : {std::tuple("Left", Key{Key::Name::Left, 0, true, false}, Held::Shift),
                                          {"Right", Key{Key::Name::Right, 0, false, true}, Held::Control},
                                          {"BackSpace", Key{Key::Name::Backspace}, Held::Nothing},
                                          {"n", Key{.letter = 'n'}, Held::Nothing}}) {
        server_->typeKey("work", name, held);
        const ScreenEvent down = next(), up = next();
        EXPECT_EQ(down.kind, Kind::KeyDown);
        EXPECT_EQ(up.kind, Kind::KeyUp);
        EXPECT_EQ(down.key, key) << name;
        EXPECT_EQ(up.key, key) << name;
    }
    server_->movePointer("work", 280 + 105, 205, XServer::Button::Pressed);
    EXPECT_EQ(next().kind, Kind::PointerMoved);
    const ScreenEvent pressed = next();
    EXPECT_EQ(pressed.kind, Kind::ButtonDown);
    EXPECT_EQ(pressed.at, glm::dvec2(10.5, 20.5));
    server_->movePointer("work", 280 + 205, 105, XServer::Button::Released);
    EXPECT_EQ(next().at, glm::dvec2(20.5, 10.5));
    EXPECT_EQ(next().kind, Kind::ButtonUp);
}

// The three ways in which a window goes are told apart. Example failure: a dead X server is taken
// for a person who closed the window.
TEST_F(PictureWindow, says_why_it_is_gone) {
    EXPECT_EQ(window_->absence(), "");
    server_->closeWindow("work");
    keysUntil('\x1b');
    EXPECT_EQ(window_->absence(), "the window was closed");
    window_ = drivers::PictureWindow::open("work", {64, 36}).value();
    server_->destroyWindow("work");
    keysUntil('\x1b');
    EXPECT_EQ(window_->absence(), "another program has destroyed the window");
    window_.reset();
    window_ = drivers::PictureWindow::open("work", {64, 36}).value();
    server_->crash();
    keysUntil('\x1b');
    EXPECT_EQ(window_->absence(), "the X server has ended");
    window_->show(GreyImage(16, 9));  // does nothing
}

TEST_F(PictureWindow, can_be_asked_for_in_advance_without_being_seen) {
    EXPECT_TRUE(drivers::PictureWindow::check());
    EXPECT_FALSE(server_->hasWindow("Fantascope"));
    window_.reset();
    server_->crash();
    EXPECT_FALSE(drivers::PictureWindow::check());
    server_->startAgain();
}

// A person chooses corners while the projectors' windows stay on the screen.
TEST_F(PictureWindow, leaves_the_windows_of_outputs_alone) {
    ManualClock clock;
    const auto output =
        drivers::openDisplay(*ConfigNode::parse("{driver: glfw}", "site.yaml"), {"left", {64, 36}, 30}, {clock}).value();
    ASSERT_TRUE(output->present());
    ASSERT_TRUE(drivers::PictureWindow::check());
    window_->show(GreyImage(16, 9));
    EXPECT_TRUE(output->present());
    window_.reset();
    EXPECT_TRUE(server_->hasWindow("left"));
    EXPECT_TRUE(output->poll());
    EXPECT_TRUE(output->present());
    EXPECT_EQ(output->context(), 1) << "it has lost its pictures";
}

}  // namespace
}  // namespace fantascope::contract
