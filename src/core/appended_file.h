#pragma once

#include "core/result.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace fantascope {

// A new file that grows for as long as the program runs, and of which a crash leaves all that was
// synced. Thread: thread-bound.
class AppendedFile {
public:
    // Error: names the file and the reason, which is also that it is there already.
    static Result<AppendedFile> create(const std::filesystem::path& path);
    ~AppendedFile();
    AppendedFile(AppendedFile&& other) noexcept;
    AppendedFile& operator=(AppendedFile&&) = delete;

    // To be written by the next sync().
    void append(std::string_view bytes) { unwritten_ += bytes; }
    // Writes what was appended and waits until the disk has it. Error: names the file and the
    // reason; nothing is lost, the next call goes on where this one stopped.
    Result<void> sync();

private:
    AppendedFile(std::filesystem::path path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}

    std::filesystem::path path_;
    int descriptor_;  // -1: moved from
    std::string unwritten_;
    bool synced_ = true;
};

}  // namespace fantascope
