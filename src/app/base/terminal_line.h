#pragma once

#include "core/clock.h"

#include <functional>
#include <ostream>
#include <string>
#include <string_view>

namespace fantascope::app {

// The width of UTF-8 text on a terminal, in columns: two for a wide character, none for a combining
// one, one for an unprintable one.
int columnsOf(std::string_view text);
// The text cut to this many columns: an ellipsis replaces the end of a longer text, "?" an
// unprintable character. columns >= 0.
std::string fitted(std::string_view text, int columns);

// "12 s", "1:05 min", "2:10 h": rounded up to whole seconds.
std::string shortDuration(Time duration);

bool standardErrorIsTerminal();
// The current width of the terminal on standard error; 80 if it is unknown.
int standardErrorColumns();

// The last line of a terminal, redrawn again and again. It never wraps, so it never scrolls, and it
// follows changes of the terminal's width. Between two drawings the cursor is at its beginning.
// Thread: one at a time.
class TerminalLine {
public:
    // `out` outlives it; `columns` is asked before each drawing.
    TerminalLine(std::ostream& out, std::function<int()> columns);
    ~TerminalLine();  // keeps the last drawing
    TerminalLine(const TerminalLine&) = delete;
    TerminalLine& operator=(const TerminalLine&) = delete;

    // The width of the next drawing: one column less than the terminal, because some terminals wrap
    // when the last column is full.
    int columns() const;
    void draw(std::string_view text);
    // Prints a permanent line above it.
    void say(std::string_view text);

private:
    std::ostream& out_;
    const std::function<int()> columns_;
    bool drawn_ = false;
};

}  // namespace fantascope::app
