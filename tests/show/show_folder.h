#pragma once

#include "core/check.h"
#include "core/file.h"

#include <unistd.h>

#include <filesystem>
#include <string>
#include <string_view>

namespace fantascope {

// A folder of a test's own, gone with the object.
class ShowFolder {
public:
    ShowFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "fantascope-show-XXXXXX").string();
        FANTASCOPE_CHECK(mkdtemp(name.data()) != nullptr, "the temporary folder can be written to");
        path_ = name;
    }
    ~ShowFolder() { std::filesystem::remove_all(path_); }
    ShowFolder(const ShowFolder&) = delete;
    ShowFolder& operator=(const ShowFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path write(const std::filesystem::path& name, std::string_view text) const {
        FANTASCOPE_CHECK(writeFile(path_ / name, text).has_value(), "the temporary folder can be written to");
        return path_ / name;
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

// `text` with the one place where `what` stands replaced.
inline std::string replaced(std::string text, std::string_view what, std::string_view by) {
    const std::size_t at = text.find(what);
    FANTASCOPE_CHECK(at != std::string::npos && text.find(what, at + 1) == std::string::npos, "stands in the text exactly once");
    return text.replace(at, what.size(), by);
}

}  // namespace fantascope
