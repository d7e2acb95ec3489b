#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace fantascope {

// Makes text from outside safe for messages. Control characters (C0, C1, DEL) and bytes that are
// not UTF-8 become "\\x1b"; a text of more than `max` bytes is cut and ends in "...". Thread: any.
std::string printable(std::string_view text, std::size_t max = 120);

// The same for a whole message: keeps its lines and its length.
std::string printableLines(std::string_view message);

// The length in bytes of the UTF-8 character (RFC 3629) at text[at]; 0: there is none.
// Requires at < text.size().
std::size_t utf8Length(std::string_view text, std::size_t at);

}  // namespace fantascope
