#include "app/base/command.h"

#include <fmt/format.h>

#include <algorithm>

namespace fantascope::app {
namespace {

bool isFileName(const std::string& text) {
    constexpr const char* kEndings[] = {".png", ".svg", ".jpg", ".jpeg", ".mp4", ".mov", ".mkv", ".pdf"};
    return text.find('/') != std::string::npos ||
           std::ranges::find(kEndings, std::filesystem::path(text).extension()) != std::end(kEndings);
}

std::string whatWasMeant(const std::string& file) {
    return fmt::format("'{}' is a file, and --output names a projector; write -o {}", file, file);
}

}  // namespace

Option addProjectorOption(Command& command, std::string& projector, const std::string& description) {
    const auto refuse = [](const std::string& given) { return isFileName(given) ? whatWasMeant(given) : ""; };
    return command.add("--output", projector, description).typeName("NAME").check({refuse, ""});
}

Option addOutOption(Command& command, std::filesystem::path& file, const std::string& description) {
    // A command without outputs answers `--output FILE` with the right option, -o.
    if (!command.has("--output")) command.addParsed("--output", whatWasMeant, "").hidden();
    return command.add("-o,--out", file, description);
}

}  // namespace fantascope::app
