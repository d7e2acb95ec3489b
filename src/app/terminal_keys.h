#pragma once

#include <termios.h>

#include <optional>

namespace fantascope::app {

// Single key presses from the terminal on standard input, without echo or Enter, for as long as it lives; nothing where standard input is
// no terminal. The terminal's own settings are put back at the end, and Ctrl-C goes on to work. Thread: thread-bound.
class TerminalKeys {
public:
    TerminalKeys();
    ~TerminalKeys();
    TerminalKeys(const TerminalKeys&) = delete;
    TerminalKeys& operator=(const TerminalKeys&) = delete;

    bool active() const { return saved_.has_value(); }
    std::optional<char> poll();  // the next key, never waits

private:
    std::optional<termios> saved_;
};

}  // namespace fantascope::app
