#pragma once

#include <memory>
#include <optional>

namespace fantascope::app {

// Single key presses from the terminal on standard input, without echo or Enter, for as long as it
// lives; nothing where standard input is no terminal, or while another program has it. The
// terminal's own settings are put back at the end, and Ctrl-C goes on to work.
// Thread: thread-bound.
class TerminalKeys {
public:
    TerminalKeys();
    ~TerminalKeys();
    TerminalKeys(const TerminalKeys&) = delete;
    TerminalKeys& operator=(const TerminalKeys&) = delete;

    bool listens() const { return saved_ != nullptr; }  // whether there is a terminal
    std::optional<char> poll();                         // the next key, never waits

private:
    struct Settings;
    std::unique_ptr<Settings> saved_;  // null: no terminal
};

}  // namespace fantascope::app
