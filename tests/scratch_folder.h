#pragma once

#include "core/check.h"
#include "core/file.h"

#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope {

// A folder of a test's own, empty at first, gone with the object.
class ScratchFolder {
public:
    ScratchFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "fantascope-XXXXXX").string();
        FANTASCOPE_CHECK(mkdtemp(name.data()) != nullptr, "the temporary folder can be written to");
        path_ = name;
    }
    ~ScratchFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::filesystem::path& name) const { return path_ / name; }
    // Makes a file and returns its path.
    std::filesystem::path file(const std::filesystem::path& name, std::string_view bytes) const {
        FANTASCOPE_CHECK(writeFile(path_ / name, bytes).has_value(), "the temporary folder can be written to");
        return path_ / name;
    }
    // The names of all that is in it, sorted.
    std::vector<std::string> names() const {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(path_)) names.push_back(entry.path().filename());
        std::sort(names.begin(), names.end());
        return names;
    }
    // A message with the folder's name taken out, wherever it stands, so that a test can spell it.
    std::string relative(std::string message) const {
        const std::string prefix = path_.string() + "/";
        for (std::size_t at; (at = message.find(prefix)) != std::string::npos;) message.erase(at, prefix.size());
        return message;
    }

private:
    std::filesystem::path path_;
};

}  // namespace fantascope
