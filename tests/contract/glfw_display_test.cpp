// What a window promises beyond every display.

#include "drivers/display/glfw.h"
#include "drivers/registry.h"

#include "contract/eventually.h"
#include "contract/x_server.h"
#include "core/check.h"

#include <epoxy/gl.h>
#include <gmock/gmock.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <limits>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace fantascope::contract {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;

std::unique_ptr<DisplaySink> open(const std::string& options, glm::ivec2 size, Clock& clock) {
    auto sink = drivers::openDisplay(*ConfigNode::parse(options, "site.yaml"), {"left", size, 30}, {clock});
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

    const BrokenPipesIgnored ignored_;
    std::unique_ptr<XServer> server_;
    ManualClock clock_;
};

// All 256 stored values, only in the picture's top row, to detect an upside-down picture. Two
// conversions on the way to the window would change some values by one; a single one nearly all.
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

// Otherwise the picture would be scaled or cropped without notice.
TEST_F(GlfwDisplay, is_absent_on_a_monitor_without_a_mode_of_its_size) {
    const auto sink = open("{driver: glfw, monitor: screen}", {1000, 700}, clock_);
    EXPECT_THAT(sink->status().detail, HasSubstr("no mode of 1000 x 700"));
}

// Otherwise, without a window manager, two windows would cover each other.
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
    // The request travels through the server, so it arrives with the events of some later frame.
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

// A technician's keyboard at the output itself. A key travels through the server, so it arrives
// with the events of some later frame.
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

// How many of the system's resources a program holds.
std::size_t entriesIn(const char* folder) {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

// Fills the display with a stored red, and shows it.
testing::AssertionResult shows(DisplaySink& sink, int red) {
    if (const auto current = sink.makeCurrent(); !current) return testing::AssertionFailure() << current.error().message();
    const GLfloat colour[] = {static_cast<float>(red) / 255, 0, 0, 1};
    glBindFramebuffer(GL_FRAMEBUFFER, sink.framebuffer());
    glDisable(GL_FRAMEBUFFER_SRGB);
    glClearBufferfv(GL_COLOR, 0, colour);
    if (const auto finished = sink.finish(); !finished) return testing::AssertionFailure() << finished.error().message();
    if (const auto shown = sink.present(); !shown) return testing::AssertionFailure() << shown.error().message();
    return testing::AssertionSuccess();
}

// Polls until it runs; another thread may have to notice first.
void comesBack(DisplaySink& sink, ManualClock& clock) {
    eventually("the display comes back", [&] {
        clock.advance(std::chrono::seconds(1));
        return sink.poll();
    });
}

// Example failure: Xlib ends the program; or each time a display, a window and a thread are left
// over.
TEST_F(GlfwDisplay, outlives_twenty_x_servers_and_leaves_nothing_of_them) {
    const auto window = open("{driver: glfw}", {64, 36}, clock_),
               monitor = open("{driver: glfw, monitor: screen}", {1280, 720}, clock_);
    std::size_t files = 0, threads = 0;
    for (int server = 1; server <= 20; ++server) {
        ASSERT_TRUE(window->poll() && monitor->poll());
        ASSERT_TRUE(shows(*window, 50));
        ASSERT_TRUE(shows(*monitor, server));
        EXPECT_EQ(server_->row(700)[0][0], server);
        if (server == 2) files = entriesIn("/proc/self/fd"), threads = entriesIn("/proc/self/task");
        server_->crash();
        if (server % 2 == 0) {
            EXPECT_FALSE(shows(*monitor, 0));  // in the middle of a frame
        }
        for (int time = 0; time < 2; ++time)
            for (DisplaySink* const sink : {window.get(), monitor.get()}) {
                EXPECT_FALSE(sink->poll());
                EXPECT_EQ(sink->status().state, DeviceState::Absent);
                EXPECT_THAT(sink->status().detail, HasSubstr("the X server has ended"));
            }
        clock_.advance(std::chrono::seconds(1));
        EXPECT_FALSE(window->poll()) << "there is none";
        server_->startAgain();
        comesBack(*window, clock_);
        comesBack(*monitor, clock_);
    }
    ASSERT_TRUE(shows(*monitor, 21));
    EXPECT_EQ(monitor->status().losses, 20);
    EXPECT_EQ(entriesIn("/proc/self/fd"), files);
    EXPECT_EQ(entriesIn("/proc/self/task"), threads);
}

// Example failure: BadWindow, for which Xlib ends the program; or there is no picture, and the
// status says Running.
TEST_F(GlfwDisplay, makes_its_window_again_that_another_program_has_destroyed) {
    const auto sink = open("{driver: glfw}", {64, 36}, clock_);
    ASSERT_TRUE(shows(*sink, 1));
    const int context = sink->context();
    server_->destroyWindow("left");
    eventually("the X server has told", [&] { return !sink->poll() || !shows(*sink, 2); });
    EXPECT_FALSE(sink->poll());
    EXPECT_THAT(sink->status().detail, HasSubstr("destroyed its window"));
    comesBack(*sink, clock_);
    EXPECT_GT(sink->context(), context);
    ASSERT_TRUE(shows(*sink, 3));
    EXPECT_TRUE(server_->hasWindow("left"));
    EXPECT_EQ(sink->status().losses, 1);
}

TEST_F(GlfwDisplay, stays_closed_on_the_next_x_server) {
    const auto sink = open("{driver: glfw}", {64, 36}, clock_);
    ASSERT_TRUE(sink->present());
    server_->closeWindow("left");
    eventually("the window is closed", [&] { return !sink->poll(); });
    server_->crash();
    server_->startAgain();
    for (int second = 0; second < 4; ++second) {
        EXPECT_FALSE(sink->poll());
        clock_.advance(std::chrono::seconds(1));
    }
    EXPECT_THAT(sink->status().detail, HasSubstr("start Fantascope again"));
    const auto other = open("{driver: glfw}", {64, 36}, clock_);
    EXPECT_TRUE(other->poll()) << "the closed one keeps nothing that others need: " << other->status().detail;
}

// A hung graphics card. Example failure: asking for the status waits for the render thread, which
// waits for the X server.
TEST_F(GlfwDisplay, tells_its_status_while_the_x_server_hangs_and_goes_on_with_it) {
    const auto sink = open("{driver: glfw}", {64, 36}, clock_);
    ASSERT_TRUE(shows(*sink, 1));
    server_->hang();
    std::jthread console([&] {
        for (int asked = 0; asked < 1000; ++asked) {
            (void)sink->status();
            (void)sink->pollEvent();
        }
        server_->goOn();
    });
    for (int frame = 0; frame < 50; ++frame) EXPECT_TRUE(shows(*sink, 2));  // the first of them wait
    EXPECT_EQ(sink->status().losses, 0);
}

// An X server that ends after a number of bytes from its clients: while GLFW starts, while a window
// is made, in a frame, anywhere.
class MortalXServer {
public:
    explicit MortalXServer(const std::string& real) {
        // A display number that no server has, at the place where clients look for it.
        for (int number = 200; listening_ < 0; ++number) {
            display_ = ":" + std::to_string(number);
            listening_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
            if (::bind(listening_, address(display_).first, address(display_).second) != 0)
                ::close(std::exchange(listening_, -1));
        }
        ::listen(listening_, 8);
        const auto [where, length] = address(real);
        std::memcpy(&real_, where, length);
        realLength_ = length;
        thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
    }
    ~MortalXServer() {
        thread_.request_stop();
        thread_.join();
        ::close(listening_);
    }
    const std::string& display() const { return display_; }
    // Counted over all connections, from now on.
    void endAfter(std::int64_t bytes) { left_ = bytes; }
    std::int64_t left() const { return left_; }

private:
    // In Linux's abstract namespace, where Xlib and XCB look first.
    static std::pair<const sockaddr*, socklen_t> address(const std::string& display) {
        static thread_local sockaddr_un name;
        name = {};
        name.sun_family = AF_UNIX;
        const std::string path = "/tmp/.X11-unix/X" + display.substr(1);
        std::memcpy(name.sun_path + 1, path.data(), path.size());
        return {reinterpret_cast<const sockaddr*>(&name),
                static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + path.size())};
    }
    void serve(const std::stop_token& stop) {
        std::vector<std::pair<int, int>> pairs;  // a client's, and the real server's
        std::array<char, 4096> bytes;
        const auto endAll = [&] {
            for (const auto& [client, server] : pairs) ::close(client), ::close(server);
            pairs.clear();
        };
        while (!stop.stop_requested()) {
            std::vector<pollfd> ready{{listening_, POLLIN, 0}};
            for (const auto& [client, server] : pairs) ready.push_back({client, POLLIN, 0}), ready.push_back({server, POLLIN, 0});
            (void)::poll(ready.data(), ready.size(), 20);
            if (left_ <= 0) endAll();
            for (std::size_t i = 0; i < pairs.size(); ++i) {
                const auto [client, server] = pairs[i];
                const auto pass = [&](int from, int to) {
                    const ssize_t count = ::recv(from, bytes.data(), bytes.size(), MSG_DONTWAIT);
                    if (count == 0) return false;
                    if (count > 0) (void)::send(to, bytes.data(), static_cast<std::size_t>(count), MSG_NOSIGNAL);
                    if (count > 0 && from == client) left_ -= count;
                    return true;
                };
                if (pass(client, server) && pass(server, client) && left_ > 0) continue;
                ::close(client), ::close(server);
                pairs.erase(pairs.begin() + static_cast<std::ptrdiff_t>(i--));
            }
            if ((ready[0].revents & POLLIN) == 0) continue;
            const int client = ::accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC);
            const int server = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
            if (left_ > 0 && ::connect(server, reinterpret_cast<const sockaddr*>(&real_), realLength_) == 0)
                pairs.emplace_back(client, server);
            else
                ::close(client), ::close(server);
        }
        endAll();
    }

    std::string display_;
    int listening_ = -1;
    sockaddr_un real_{};
    socklen_t realLength_ = 0;
    std::atomic<std::int64_t> left_ = std::numeric_limits<std::int64_t>::max();
    std::jthread thread_;
};

// Example failure: Xlib ends the program, because so early no handler is set.
TEST_F(GlfwDisplay, outlives_an_x_server_that_ends_at_any_byte_of_its_greeting) {
    MortalXServer server(server_->display());
    ::setenv("DISPLAY", server.display().c_str(), 1);
    constexpr std::int64_t kPlenty = 1 << 30;
    server.endAfter(kPlenty);
    ASSERT_TRUE(drivers::GlfwLibrary::shared());
    const std::int64_t whole = kPlenty - server.left();
    ASSERT_GT(whole, 1'000);
    constexpr int kLives = 30;
    int refused = 0;
    for (int life = 0; life < kLives; ++life) {
        server.endAfter(1 + whole * life / kLives);
        refused += drivers::GlfwLibrary::shared() ? 0 : 1;
    }
    EXPECT_GT(refused, kLives / 2);
    server.endAfter(kPlenty);
    EXPECT_TRUE(open("{driver: glfw}", {16, 9}, clock_)->poll()) << "and the next one is as good as the first";
}

// Example failure: Xlib writes a request beyond its buffer, and crashes.
TEST_F(GlfwDisplay, outlives_an_x_server_that_ends_at_any_byte_of_a_frame) {
    MortalXServer server(server_->display());
    ::setenv("DISPLAY", server.display().c_str(), 1);
    const auto sink = open("{driver: glfw}", {16, 9}, clock_);
    for (int life = 0; life < 20; ++life) {
        server.endAfter(1 << 30);
        comesBack(*sink, clock_);
        server.endAfter(1 + 30 * life);
        eventually("it is lost", [&] { return !shows(*sink, life); });
        EXPECT_FALSE(sink->poll());
        EXPECT_EQ(sink->status().losses, life + 1);
    }
}

TEST_F(GlfwDisplay, refuses_a_wrong_key) {
    const auto sink = drivers::openDisplay(*ConfigNode::parse("{driver: glfw, monitr: a}", "site.yaml"), {}, {clock_});
    ASSERT_FALSE(sink);
    EXPECT_THAT(sink.error().message(), HasSubstr("monitor"));
}

}  // namespace
}  // namespace fantascope::contract
