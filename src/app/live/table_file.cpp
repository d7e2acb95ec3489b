#include "app/live/table_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

namespace fantascope::app {

namespace fs = std::filesystem;

void TableFile::add(std::string_view line) {
    const std::lock_guard lock(mutex_);
    if (ended_ || overflowed_) return;
    overflowed_ = waiting_.size() + line.size() > kMostWaiting;
    if (!overflowed_) waiting_ += line;
}

Error TableFile::refused(int reason) const {
    return Error(fmt::format("{}: cannot be written: {}", path_.string(), std::strerror(reason)));
}

Result<void> TableFile::open() {
    std::error_code unknown;  // ignored: an error will show when the file is opened
    if (path_.has_parent_path()) fs::create_directories(path_.parent_path(), unknown);
    file_ = drivers::FileHandle(::open(unfinished().c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
    if (!file_.isOpen()) return refused(errno);
    return {};
}

Result<void> TableFile::append(std::string_view text) {
    if (!file_.isOpen()) TRY(open());
    while (!text.empty()) {
        const ssize_t written = ::write(file_.get(), text.data(), text.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return refused(errno);
        text.remove_prefix(static_cast<std::size_t>(written));
    }
    return {};
}

Result<void> TableFile::write() {
    writing_.clear();
    bool overflowed = false;
    {
        const std::lock_guard lock(mutex_);
        if (ended_) return {};
        std::swap(writing_, waiting_);
        overflowed = overflowed_;
    }
    Result<void> written = append(writing_);
    if (written && overflowed) written = Error(path_.string() + ": the disk does not keep up");
    if (written) return {};
    file_ = {};
    const std::lock_guard lock(mutex_);
    ended_ = true;
    waiting_ = {};
    return written;
}

Result<void> TableFile::finish() {
    TRY(write());
    {
        const std::lock_guard lock(mutex_);
        if (std::exchange(ended_, true)) return {};
    }
    const bool synced = ::fsync(file_.get()) == 0;
    const int why = errno;
    file_ = {};
    if (!synced) return refused(why);
    std::error_code failure;
    fs::rename(unfinished(), path_, failure);
    if (failure) return refused(failure.value());
    return {};
}

}  // namespace fantascope::app
