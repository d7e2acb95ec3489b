#include "core/appended_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace fantascope {

Result<AppendedFile> AppendedFile::create(const std::filesystem::path& path) {
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666);
    if (descriptor < 0) return Error(fmt::format("{}: {}", path.string(), std::strerror(errno)));
    return AppendedFile(path, descriptor);
}

AppendedFile::AppendedFile(AppendedFile&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      unwritten_(std::move(other.unwritten_)),
      synced_(other.synced_) {}

AppendedFile::~AppendedFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

Result<void> AppendedFile::sync() {
    while (!unwritten_.empty()) {
        const ssize_t written = ::write(descriptor_, unwritten_.data(), unwritten_.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return Error(fmt::format("{}: {}", path_.string(), std::strerror(errno)));
        synced_ = false;
        unwritten_.erase(0, static_cast<std::size_t>(written));
    }
    if (!synced_ && ::fdatasync(descriptor_) != 0) return Error(fmt::format("{}: {}", path_.string(), std::strerror(errno)));
    synced_ = true;
    return {};
}

}  // namespace fantascope
