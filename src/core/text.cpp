#include "core/text.h"

#include <fmt/format.h>

#include <limits>

namespace fantascope {
namespace {

// Whether a terminal would obey the character instead of showing it. In UTF-8, U+0080 to U+009F
// begin with 0xc2.
bool isControl(std::string_view character) {
    const auto lead = static_cast<unsigned char>(character[0]);
    return lead < 0x20 || lead == 0x7f || (lead == 0xc2 && static_cast<unsigned char>(character[1]) < 0xa0);
}

}  // namespace

std::size_t utf8Length(std::string_view text, std::size_t at) {
    const auto byte = [&](std::size_t index) { return static_cast<unsigned char>(text[index]); };
    const unsigned char lead = byte(at);
    const std::size_t length = lead < 0x80 ? 1 : lead < 0xc2 ? 0 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : lead < 0xf5 ? 4 : 0;
    if (length == 0 || at + length > text.size()) return 0;
    for (std::size_t next = 1; next < length; ++next)
        if ((byte(at + next) & 0xc0) != 0x80) return 0;
    return length;
}

std::string printable(std::string_view text, std::size_t max) {
    std::string shown;
    for (std::size_t at = 0; at < text.size();) {
        if (at >= max) return shown + "...";
        const std::size_t length = utf8Length(text, at);
        const std::string_view character = text.substr(at, length == 0 ? 1 : length);
        if (length == 0 || isControl(character))
            for (const char byte : character) shown += fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
        else
            shown += character;
        at += character.size();
    }
    return shown;
}

std::string printableLines(std::string_view message) {
    std::string shown;
    for (std::size_t begin = 0;;) {
        const std::size_t end = message.find('\n', begin);
        shown += printable(message.substr(begin, end - begin), std::numeric_limits<std::size_t>::max());
        if (end == std::string_view::npos) return shown;
        shown += '\n';
        begin = end + 1;
    }
}

}  // namespace fantascope
