#include "core/config/file_place.h"

#include "core/text.h"

#include <fmt/format.h>

namespace fantascope {
namespace {

// Names that a file's author chose are quoted in messages; no more than this of them.
constexpr std::size_t kLongestMessage = 2000;

}  // namespace

std::string FilePlace::text() const { return fmt::format("{}:{}:{}", file.string(), line, column); }

Error FilePlace::error(const std::string& message) const { return error(Error(printable(message, kLongestMessage))); }

Error FilePlace::error(const Error& cause) const {
    return Error(fmt::format("{}: {}{}{}", text(), key, key.empty() ? "" : ": ", cause.message()));
}

}  // namespace fantascope
