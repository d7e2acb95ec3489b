#pragma once

#include <memory>
#include <optional>

namespace fantascope::app {

// While an object lives, it reads single key presses from the terminal on standard input, without
// echo or Enter. It reads nothing if standard input is no terminal, or while another program has
// the terminal. The destructor restores the terminal's settings. Ctrl-C keeps working. Thread:
// thread-bound.
class TerminalKeys {
public:
    TerminalKeys();
    ~TerminalKeys();
    TerminalKeys(const TerminalKeys&) = delete;
    TerminalKeys& operator=(const TerminalKeys&) = delete;

    bool listens() const { return saved_ != nullptr; }  // whether there is a terminal
    std::optional<char> poll();                         // the next key; never waits

private:
    struct Settings;
    std::unique_ptr<Settings> saved_;  // null: no terminal
};

}  // namespace fantascope::app
