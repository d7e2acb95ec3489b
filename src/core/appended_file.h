#pragma once

#include "core/result.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace fantascope {

// A file that grows for as long as the program runs, and of which a crash of the program leaves all
// that was written, and one of the machine all that was synced. One program at a time has it open.
// Thread: thread-bound, except where a function says otherwise.
class AppendedFile {
public:
    // Opens a file, or makes it, and cuts it to its first `bytes`. Error: names the file and the
    // reason, which is also that it is open elsewhere.
    static Result<AppendedFile> open(const std::filesystem::path& path, std::uintmax_t bytes);
    // Whether another program has it open in this way.
    static bool isOpenElsewhere(const std::filesystem::path& path);
    ~AppendedFile();
    AppendedFile(AppendedFile&& other) noexcept;
    AppendedFile& operator=(AppendedFile&&) = delete;

    // To be written by the next write().
    void append(std::string_view bytes) { unwritten_ += bytes; }
    std::size_t unwritten() const { return unwritten_.size(); }
    std::uintmax_t written() const { return written_; }  // bytes of the file
    // Gives what was appended to the system. Error: names the file and the reason; nothing is lost,
    // the next call goes on where this one stopped.
    Result<void> write();
    // Waits until the disk has what was written. Error: names the file and the reason. Thread: any.
    Result<void> sync() const;

private:
    AppendedFile(std::filesystem::path path, int descriptor, std::uintmax_t bytes)
        : path_(std::move(path)), descriptor_(descriptor), written_(bytes) {}

    std::filesystem::path path_;
    int descriptor_;  // -1: moved from
    std::string unwritten_;
    std::uintmax_t written_;
};

}  // namespace fantascope
