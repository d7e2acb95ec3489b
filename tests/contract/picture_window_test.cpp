#include "drivers/display/picture_window.h"

#include "contract/x_server.h"

#include <gmock/gmock.h>

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

}  // namespace
}  // namespace fantascope::contract
