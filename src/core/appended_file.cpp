#include "core/appended_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace fantascope {

namespace {

Error errorOf(const std::filesystem::path& path) { return Error(fmt::format("{}: {}", path.string(), std::strerror(errno))); }

}  // namespace

Result<AppendedFile> AppendedFile::open(const std::filesystem::path& path, std::uintmax_t bytes) {
    AppendedFile file(path, ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0644),
                      bytes);
    if (file.descriptor_ < 0) return errorOf(path);
    if (::flock(file.descriptor_, LOCK_EX | LOCK_NB) != 0) return errorOf(path);
    if (::ftruncate(file.descriptor_, static_cast<off_t>(bytes)) != 0) return errorOf(path);
    return file;
}

bool AppendedFile::isOpenElsewhere(const std::filesystem::path& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (descriptor < 0) return false;
    const bool is = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    ::close(descriptor);
    return is;
}

AppendedFile::AppendedFile(AppendedFile&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      unwritten_(std::move(other.unwritten_)),
      written_(other.written_) {}

AppendedFile::~AppendedFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

Result<void> AppendedFile::write() {
    while (!unwritten_.empty()) {
        const ssize_t written = ::write(descriptor_, unwritten_.data(), unwritten_.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return errorOf(path_);
        written_ += static_cast<std::uintmax_t>(written);
        unwritten_.erase(0, static_cast<std::size_t>(written));
    }
    return {};
}

Result<void> AppendedFile::sync() const { return ::fdatasync(descriptor_) == 0 ? Result<void>() : errorOf(path_); }

}  // namespace fantascope
