#include "app/base/command.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

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

CLI::Option* addProjectorOption(CLI::App& command, std::string& projector, const std::string& description) {
    return command.add_option("--output", projector, description)->type_name("NAME")->check([](const std::string& given) {
        return isFileName(given) ? whatWasMeant(given) : std::string();
    });
}

void refuseProjectorOption(CLI::App& command) {
    const auto refuse = [](const std::string& given) { throw CLI::ValidationError("--output", whatWasMeant(given)); };
    command.add_option_function<std::string>("--output", refuse)->group("");  // --help does not list it
}

}  // namespace fantascope::app
