#pragma once

#include "core/result.h"

#include <filesystem>
#include <string>
#include <utility>

namespace fantascope::app {

// A new folder for files that must have a name for a moment. It is gone with the object.
class TemporaryFolder {
public:
    // Error: the system's folder for such files cannot be written to.
    static Result<TemporaryFolder> make();
    TemporaryFolder(TemporaryFolder&& other) noexcept : path_(std::exchange(other.path_, "")) {}
    TemporaryFolder& operator=(TemporaryFolder&&) = delete;
    ~TemporaryFolder();

    std::filesystem::path operator/(const std::filesystem::path& name) const { return path_ / name; }

private:
    explicit TemporaryFolder(std::filesystem::path path) : path_(std::move(path)) {}
    std::filesystem::path path_;
};

}  // namespace fantascope::app
