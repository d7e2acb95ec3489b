#include "app/base/terminal_keys.h"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

namespace fantascope::app {
namespace {

// A background process that touches its terminal would be stopped, or would take keys and settings
// from the foreground process.
bool isInFront() { return tcgetpgrp(STDIN_FILENO) == getpgrp(); }

}  // namespace

struct TerminalKeys::Settings {
    termios value{};
};

TerminalKeys::TerminalKeys() {
    termios settings{};
    if (isatty(STDIN_FILENO) == 0 || !isInFront() || tcgetattr(STDIN_FILENO, &settings) != 0) return;
    saved_ = std::make_unique<Settings>(Settings{settings});
    settings.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    tcsetattr(STDIN_FILENO, TCSANOW, &settings);
}

TerminalKeys::~TerminalKeys() {
    if (saved_ && isInFront()) tcsetattr(STDIN_FILENO, TCSANOW, &saved_->value);
}

std::optional<char> TerminalKeys::poll() {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    char key = 0;
    if (!saved_ || ::poll(&input, 1, 0) <= 0 || !isInFront() || read(STDIN_FILENO, &key, 1) != 1) return std::nullopt;
    return key;
}

}  // namespace fantascope::app
