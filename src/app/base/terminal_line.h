#pragma once

#include "core/clock.h"

#include <functional>
#include <ostream>
#include <string>
#include <string_view>

namespace fantascope::app {

// How many columns UTF-8 text takes on a terminal: two a wide character, none a combining one, one
// for whatever is not to be printed.
int columnsOf(std::string_view text);
// The text as it fits into that many columns: the end of what does not fit becomes an ellipsis, and
// what is not to be printed "?". columns >= 0.
std::string fitted(std::string_view text, int columns);

// "12 s", "1:05 min", "2:10 h": rounded up to whole seconds.
std::string shortDuration(Time duration);

bool standardErrorIsTerminal();
// Of the terminal on standard error as it is now; 80 where that does not say.
int standardErrorColumns();

// The last line of a terminal, drawn over and over. It never wraps and so never scrolls, and it
// follows a terminal that is made wider or narrower. Between two drawings the cursor stands at its
// beginning. Thread: one at a time.
class TerminalLine {
public:
    // `out` outlives it; `columns` is asked before each drawing.
    TerminalLine(std::ostream& out, std::function<int()> columns);
    ~TerminalLine();  // leaves the last drawing standing
    TerminalLine(const TerminalLine&) = delete;
    TerminalLine& operator=(const TerminalLine&) = delete;

    // How many columns the next drawing may have: one fewer than the terminal, as some wrap when
    // the last one is full.
    int columns() const;
    void draw(std::string_view text);
    // A line that stays, above it.
    void say(std::string_view text);

private:
    std::ostream& out_;
    const std::function<int()> columns_;
    bool drawn_ = false;
};

}  // namespace fantascope::app
