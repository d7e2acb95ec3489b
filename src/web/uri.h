#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fantascope::web {

// What a request is for, decoded (RFC 3986).
struct Target {
    std::string path;
    std::vector<std::pair<std::string, std::string>> query;
};
// Takes "/a%20b?c=d" apart. Nothing: it is no such target, or has a character that is no text.
std::optional<Target> splitTarget(std::string_view target);

}  // namespace fantascope::web
