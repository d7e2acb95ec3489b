#include "app/base/terminal_line.h"

#include <fmt/format.h>
#include <locale.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <wchar.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::app {
namespace {

constexpr int kUsualColumns = 80;
constexpr const char* kWipe = "\r\x1b[J";         // to the line's beginning, then clear to the screen's end
constexpr std::string_view kEllipsis = "\u2026";  // one column

// While an object lives, the C library reads UTF-8 on this thread, whatever the user's locale.
class Utf8 {
public:
    Utf8() : before_(uselocale(own())) {}
    ~Utf8() { uselocale(before_); }
    Utf8(const Utf8&) = delete;
    Utf8& operator=(const Utf8&) = delete;

private:
    static locale_t own() {
        static const locale_t locale = newlocale(LC_CTYPE_MASK, "C.UTF-8", nullptr);
        return locale;
    }
    locale_t before_;
};

struct Glyph {
    std::string_view bytes;
    int columns;
};

// The first character of `text`, which is not empty.
Glyph firstOf(std::string_view text) {
    wchar_t character = 0;
    mbstate_t state{};
    const std::size_t bytes = mbrtowc(&character, text.data(), text.size(), &state);
    if (bytes == 0 || bytes > text.size()) return {"?", 1};  // a zero, or no UTF-8
    const int columns = wcwidth(character);
    if (columns < 0) return {"?", 1};
    return {text.substr(0, bytes), columns};
}

// Calls `use` with each character and its number of bytes, as long as `use` returns true.
void forEach(std::string_view text, auto use) {
    const Utf8 utf8;
    while (!text.empty()) {
        const Glyph glyph = firstOf(text);
        if (!use(glyph)) return;
        text.remove_prefix(glyph.bytes.data() == text.data() ? glyph.bytes.size() : 1);
    }
}

}  // namespace

int columnsOf(std::string_view text) {
    int columns = 0;
    forEach(text, [&](const Glyph& glyph) {
        columns += glyph.columns;
        return true;
    });
    return columns;
}

std::string fitted(std::string_view text, int columns) {
    if (columns == 0) return "";
    const bool fits = columnsOf(text) <= columns;
    std::string beginning;
    forEach(text, [&, left = fits ? columns : columns - 1](const Glyph& glyph) mutable {
        left -= glyph.columns;
        if (left < 0) return false;
        beginning += glyph.bytes;
        return true;
    });
    return fits ? beginning : beginning + std::string(kEllipsis);
}

std::string shortDuration(Time duration) {
    const auto whole = static_cast<long>(std::ceil(seconds(duration)));
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{}:{:02} min", whole / 60, whole % 60);
    return fmt::format("{}:{:02} h", whole / 3600, whole / 60 % 60);
}

bool standardErrorIsTerminal() { return ::isatty(STDERR_FILENO) != 0; }

int standardErrorColumns() {
    winsize size{};
    return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kUsualColumns;
}

TerminalLine::TerminalLine(std::ostream& out, std::function<int()> columns) : out_(out), columns_(std::move(columns)) {}

TerminalLine::~TerminalLine() {
    if (drawn_) out_ << std::endl;
}

int TerminalLine::columns() const { return std::max(0, columns_() - 1); }

// The cursor goes back to the beginning. If the terminal is made narrower it wraps the line, and
// clearing from the beginning removes all of it.
void TerminalLine::draw(std::string_view text) {
    drawn_ = true;
    out_ << kWipe << fitted(text, columns()) << '\r' << std::flush;
}

void TerminalLine::say(std::string_view text) {
    out_ << kWipe << text << std::endl;
    drawn_ = false;
}

}  // namespace fantascope::app
