#pragma once
// An X server of the test's own, and what a person in front of its screen sees and does.

#include "drivers/common/file_handle.h"

#include "core/result.h"

#include <sys/types.h>

#include <array>
#include <csignal>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fantascope {

// An X server without a window manager. While it runs, DISPLAY names it.
class XServer {
public:
    // Xvfb with one screen of 1280 x 720 pixels, monitor "screen". Error: it is not installed or
    // does not start.
    static Result<std::unique_ptr<XServer>> start();
    // `command` starts an X server; the number of a display, -noreset and -displayfd are added.
    // Error: it does not start.
    static Result<std::unique_ptr<XServer>> start(std::vector<std::string> command);
    ~XServer();
    XServer(const XServer&) = delete;
    XServer& operator=(const XServer&) = delete;

    const std::string& display() const { return display_; }  // ":99"
    // What the screen shows in its row `y` from the top: pixels of red, green, blue as they are
    // stored.
    std::vector<std::array<std::uint8_t, 3>> row(int y) const;
    std::vector<std::vector<std::array<std::uint8_t, 3>>> rows() const;  // all of them
    bool hasWindow(const std::string& title) const;                      // a visible one
    // Presses a key while the window has the focus; the key's name as xmodmap has it: "space",
    // "Escape", "a".
    void pressKey(const std::string& title, const std::string& key) const;
    // Presses and releases it, while Shift or Control is held.
    enum class Held { Nothing, Shift, Control };
    void typeKey(const std::string& title, const std::string& key, Held held = Held::Nothing) const;
    // Moves the pointer to a pixel of the window, and presses or releases the left button there.
    enum class Button { Untouched, Pressed, Released };
    void movePointer(const std::string& title, int x, int y, Button button = Button::Untouched) const;
    // Asks the window to close, like its close button.
    void closeWindow(const std::string& title) const;
    // Destroys the window, as no well-behaved program does.
    void destroyWindow(const std::string& title) const;
    // Ends the connection of the window's program, like `xkill`.
    void killProgramOf(const std::string& title) const;

    // The fate of the server itself: it crashes, and a new one starts on the same display; it
    // hangs, and goes on.
    void crash();
    void startAgain();
    void hang() const;
    void goOn() const;

private:
    XServer(std::vector<std::string> command, pid_t child, int number, drivers::FileHandle claim);

    const std::vector<std::string> command_;
    pid_t child_;
    const int number_;
    const drivers::FileHandle claim_;  // while it is open, no other test takes the number, not even after a crash
    const std::string display_;
    std::optional<std::string> displayBefore_;
};

// While one exists, SIGPIPE from an ended connection does not end the program.
class BrokenPipesIgnored {
public:
    BrokenPipesIgnored() = default;
    ~BrokenPipesIgnored() { std::signal(SIGPIPE, before_); }
    BrokenPipesIgnored(const BrokenPipesIgnored&) = delete;
    BrokenPipesIgnored& operator=(const BrokenPipesIgnored&) = delete;

private:
    void (*const before_)(int) = std::signal(SIGPIPE, SIG_IGN);
};

}  // namespace fantascope
