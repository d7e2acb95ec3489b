#include "app/base/output.h"

#include "core/file.h"

#include <fmt/format.h>
#include <unistd.h>

namespace fantascope::app {

namespace fs = std::filesystem;

ValueCheck onlyYaml(const std::string& example) {
    return {[example](const std::string& file) {
                return fs::path(file).extension() == ".yaml"
                           ? std::string()
                           : fmt::format("'{}' is not {}: its name has to end in .yaml", file, example);
            },
            "YAML"};
}

ValueCheck onlyEnding(const std::string& ending, const std::string& type) {
    return {[ending](const std::string& file) {
                return fs::path(file).extension() == ending ? std::string()
                                                            : fmt::format("'{}' does not end in {}", file, ending);
            },
            type};
}

Result<void> checkWritable(const fs::path& file) {
    std::error_code ignored;
    if (fs::is_directory(file, ignored)) return Error(fmt::format("{}: cannot be written: it is a folder", file.string()));
    fs::path folder = fs::absolute(file).parent_path();
    while (!fs::exists(folder, ignored) && folder.has_relative_path()) folder = folder.parent_path();
    if (fs::is_directory(folder, ignored) && ::access(folder.c_str(), W_OK) == 0) return {};
    return Error(fmt::format("{}: cannot be written: {} is not a folder that may be written to", file.string(), folder.string()));
}

Material materialFor(const fs::path& output, const fs::path& source, const std::string& suffix) {
    const fs::path relative =
        fs::weakly_canonical(source).lexically_relative(fs::weakly_canonical(fs::absolute(output).parent_path()));
    if (!relative.empty() && *relative.begin() != "..") return {source, relative.generic_string(), false};
    const std::string stem = output.stem().stem().string();
    return {source, fmt::format("{}.{}", stem, suffix), true};
}

Result<void> copyTo(const fs::path& folder, const Material& material) {
    if (!material.copied) return {};
    const std::string content = TRY(readFile(material.source, kMaxFileBytes));
    return writeFile(folder / material.name, content);
}

}  // namespace fantascope::app
