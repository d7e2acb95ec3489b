#pragma once

#include "core/check.h"

#include <string>
#include <string_view>

namespace fantascope {

// `text` with the one place where `what` stands replaced.
inline std::string replaced(std::string text, std::string_view what, std::string_view by) {
    const std::size_t at = text.find(what);
    FANTASCOPE_CHECK(at != std::string::npos && text.find(what, at + 1) == std::string::npos, "stands in the text exactly once");
    return text.replace(at, what.size(), by);
}

}  // namespace fantascope
