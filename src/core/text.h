#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace fantascope {

// Text from outside as it may stand in a message. Control characters (C0, C1, DEL) and bytes that
// are not UTF-8 become "\\x1b"; a text of more than `most` bytes loses its end to "...". Thread:
// any.
std::string printable(std::string_view text, std::size_t most = 120);

// The same of a whole message: its lines stay, and so does its length.
std::string printableLines(std::string_view message);

// The number of bytes of the UTF-8 character (RFC 3629) that begins at text[at]; 0: none does.
// Before: at < text.size().
std::size_t utf8Length(std::string_view text, std::size_t at);

}  // namespace fantascope
