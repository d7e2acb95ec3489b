#pragma once

#include "drivers/common/file_handle.h"

#include "core/result.h"

#include <cstddef>
#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>

namespace fantascope::app {

// A text file that grows line by line while a show runs. Whoever adds a line never waits for the
// disk: lines wait in memory until somebody writes them, about every second. Until finish() the
// file is called PATH.unfinished, and a program that ends before leaves that behind, whole lines up
// to some point.
// Thread: add() from any; the rest from one at a time.
class TableFile {
public:
    // So much may wait for a disk that does not keep up.
    static constexpr std::size_t kMostWaiting = std::size_t{64} << 20;  // bytes

    // Nothing is written yet. `heading`: the first line, with its end.
    TableFile(std::filesystem::path path, std::string heading) : path_(std::move(path)), waiting_(std::move(heading)) {}

    void add(std::string_view line);  // with its end
    // Writes what waits. Error, once: names the file, and why it ends here; whatever is added later
    // is left out.
    Result<void> write();
    // The same, and gives the file its name.
    Result<void> finish();

private:
    Result<void> open();
    Result<void> append(std::string_view text);
    std::filesystem::path unfinished() const { return path_.string() + ".unfinished"; }
    Error refused(int reason) const;

    const std::filesystem::path path_;
    drivers::FileHandle file_;  // closed before the first write(), and once it has ended
    std::string writing_;       // what write() has taken; keeps its room
    std::mutex mutex_;          // of:
    std::string waiting_;
    bool overflowed_ = false, ended_ = false;
};

}  // namespace fantascope::app
