#pragma once

#include "drivers/common/file_handle.h"

#include "core/result.h"

#include <cstddef>
#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>

namespace fantascope::app {

// A text file that grows line by line while a show runs. add() never waits for the disk: lines wait
// in memory until write(), about every second. Until finish() the file is called PATH.unfinished. A
// program that ends earlier leaves that file, with whole lines up to some point.
// Thread: add() from any; the rest from one at a time.
class TableFile {
public:
    // The most text that may wait for a slow disk.
    static constexpr std::size_t kMostWaiting = std::size_t{64} << 20;  // bytes

    // Writes nothing yet. `heading`: the first line, with its line end.
    TableFile(std::filesystem::path path, std::string heading) : path_(std::move(path)), waiting_(std::move(heading)) {}

    void add(std::string_view line);  // with its line end
    // Writes the waiting lines. Error, only once: names the file, and why it ends here. Lines added
    // later are dropped.
    Result<void> write();
    // Writes the waiting lines, and gives the file its name.
    Result<void> finish();

private:
    Result<void> open();
    Result<void> append(std::string_view text);
    std::filesystem::path unfinished() const { return path_.string() + ".unfinished"; }
    Error refused(int reason) const;

    const std::filesystem::path path_;
    drivers::FileHandle file_;  // closed before the first write(), and once the file has ended
    std::string writing_;       // what write() has taken; a member, so that it keeps its capacity
    std::mutex mutex_;          // of:
    std::string waiting_;
    bool overflowed_ = false, ended_ = false;
};

}  // namespace fantascope::app
