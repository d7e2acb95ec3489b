#include "core/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>

namespace fantascope {

namespace fs = std::filesystem;

namespace {

Error notRead(const fs::path& path, int reason) {
    return Error(fmt::format("{}: cannot be read: {}", path.string(), std::strerror(reason)));
}

Error notWritten(const fs::path& path, int reason) {
    return Error(fmt::format("{}: cannot be written: {}", path.string(), std::strerror(reason)));
}

// The file that a path names, links followed, which a new one may replace. Error: as
// NewFile::open()'s.
Result<fs::path> targetOf(const fs::path& path) {
    fs::path target = path;
    std::error_code failure, ignored;
    if (fs::is_symlink(path, ignored)) target = fs::canonical(path, failure);
    if (failure) return notWritten(path, failure.value());  // a dangling link
    struct stat standing = {};
    if (::stat(target.c_str(), &standing) != 0) return target;
    if (!S_ISREG(standing.st_mode) && !S_ISDIR(standing.st_mode))
        return Error(fmt::format("{}: cannot be written: it is a device or a pipe, a file is needed", path.string()));
    if ((standing.st_mode & 0222) == 0 || ::access(target.c_str(), W_OK) != 0) return notWritten(path, EACCES);
    return target;
}

Result<void> checkKind(const fs::path& path, const struct stat& found) {
    if (S_ISREG(found.st_mode)) return {};
    const char* const kind = S_ISDIR(found.st_mode)    ? "folder"
                             : S_ISFIFO(found.st_mode) ? "pipe"
                             : S_ISSOCK(found.st_mode) ? "socket"
                                                       : "device";
    return Error(fmt::format("{}: is a {}, a file is needed", path.string(), kind));
}

// Reads up to `bytes` of a file whose size may be `max`.
Result<std::string> read(const fs::path& path, std::size_t bytes, std::uintmax_t max) {
    TRY(checkRegular(path));
    // The path may have changed meanwhile, so this must not block on a pipe, either.
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (descriptor < 0) return notRead(path, errno);
    struct Closed {
        int descriptor;
        ~Closed() { ::close(descriptor); }
    } const closed{descriptor};
    struct stat found = {};
    if (::fstat(descriptor, &found) != 0) return notRead(path, errno);
    TRY(checkKind(path, found));
    const auto tooLarge = [&](std::uintmax_t size) {
        constexpr double kMebi = 1 << 20;
        return Error(
            fmt::format("{}: is too large, {:.1f} MiB: such a file has at most {:.0f} MiB; make it smaller, or name another",
                        path.string(), static_cast<double>(size) / kMebi, static_cast<double>(max) / kMebi));
    };
    if (static_cast<std::uintmax_t>(found.st_size) > max) return tooLarge(static_cast<std::uintmax_t>(found.st_size));
    std::string content;
    content.reserve(std::min(bytes, static_cast<std::size_t>(found.st_size)));
    std::array<char, 65536> part;
    while (content.size() < bytes) {
        const ssize_t count = ::read(descriptor, part.data(), std::min(part.size(), bytes - content.size()));
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) return notRead(path, errno);
        if (count == 0) break;
        content.append(part.data(), static_cast<std::size_t>(count));
        if (content.size() > max) return tooLarge(content.size());  // it grew
    }
    return content;
}

}  // namespace

Result<std::string> readFile(const fs::path& path, std::uintmax_t max) {
    return read(path, std::numeric_limits<std::size_t>::max(), max);
}

Result<std::string> readStart(const fs::path& path, std::size_t bytes) {
    return read(path, bytes, std::numeric_limits<std::uintmax_t>::max());
}

Result<void> checkRegular(const fs::path& path) {
    struct stat found = {};
    return ::stat(path.c_str(), &found) == 0 ? checkKind(path, found) : Result<void>();
}

Result<NewFile> NewFile::open(const fs::path& path) {
    std::error_code failure;
    if (path.has_parent_path()) fs::create_directories(path.parent_path(), failure);
    if (failure) return notWritten(path, failure.value());
    NewFile file(path, TRY(targetOf(path)));

    const fs::path folder = file.target_.has_parent_path() ? file.target_.parent_path() : ".";
    // Giving a nameless file its name needs /proc.
    const bool hasProc = ::access("/proc/self/fd", X_OK) == 0;
    if (hasProc) file.descriptor_ = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (!hasProc || (file.descriptor_ < 0 && (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL))) {
        std::string aside = file.target_.string() + ".XXXXXX";  // for mkostemp(3)
        file.descriptor_ = ::mkostemp(aside.data(), O_CLOEXEC);
        if (file.descriptor_ >= 0) file.aside_ = std::move(aside);
    }
    if (file.descriptor_ < 0) return file.refused(errno);
    return file;
}

NewFile::NewFile(NewFile&& other) noexcept
    : path_(std::move(other.path_)),
      target_(std::move(other.target_)),
      aside_(std::exchange(other.aside_, {})),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

NewFile::~NewFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!aside_.empty()) ::unlink(aside_.c_str());
}

Error NewFile::refused(int reason) const { return notWritten(path_, reason); }

Result<void> NewFile::write(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return refused(errno);
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return {};
}

bool NewFile::giveName() {
    if (aside_.empty()) {
        const std::string nameless = fmt::format("/proc/self/fd/{}", descriptor_);
        const auto link = [&](const std::string& name) {
            return ::linkat(AT_FDCWD, nameless.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
        };
        if (link(target_)) return true;
        if (errno != EEXIST) return false;
        // link(2) cannot replace a file, only rename(2) can. So the file gets a temporary name for
        // a moment.
        std::string name;
        for (int attempt = 0; aside_.empty(); ++attempt) {
            name = fmt::format("{}.{}-{}", target_.string(), ::getpid(), attempt);
            if (link(name))
                aside_ = name;
            else if (errno != EEXIST)
                return false;
        }
    }
    if (::rename(aside_.c_str(), target_.c_str()) != 0) return false;
    aside_.clear();
    return true;
}

Result<void> NewFile::finish(const fs::path& like) {
    struct stat model = {};
    const bool modelled = ::stat(like.empty() ? target_.c_str() : like.c_str(), &model) == 0;
    // Only root may give a file away; others may give it to a group of their own. If neither is
    // allowed, the file belongs to the writer.
    [[maybe_unused]] const bool given = modelled && (::fchown(descriptor_, model.st_uid, model.st_gid) == 0 ||
                                                     ::fchown(descriptor_, static_cast<uid_t>(-1), model.st_gid) == 0);
    if (::fchmod(descriptor_, modelled ? model.st_mode & 0777 : 0644) != 0 || ::fsync(descriptor_) != 0 || !giveName())
        return refused(errno);
    return {};
}

Result<void> writeFile(const fs::path& path, std::string_view bytes, const fs::path& like) {
    NewFile file = TRY(NewFile::open(path));
    TRY(file.write(bytes));
    return file.finish(like);
}

Result<void> exchangeFiles(const fs::path& a, const fs::path& b) {
    const fs::path one = TRY(targetOf(a)), other = TRY(targetOf(b));
    if (::renameat2(AT_FDCWD, one.c_str(), AT_FDCWD, other.c_str(), RENAME_EXCHANGE) == 0) return {};
    if (errno != EINVAL && errno != ENOSYS && errno != EXDEV) return notWritten(a, errno);
    const std::string ones = TRY(readFile(a, kMaxFileBytes)), others = TRY(readFile(b, kMaxFileBytes));
    TRY(writeFile(a, others));
    return writeFile(b, ones);
}

Result<std::string> relativeTo(const std::filesystem::path& file, const std::filesystem::path& path) {
    std::error_code noWorkingDirectory;  // then the paths stay as they are
    const auto absolute = [&](const std::filesystem::path& p) {
        return std::filesystem::absolute(p, noWorkingDirectory).lexically_normal();
    };
    const std::filesystem::path relative = absolute(path).lexically_relative(absolute(file).parent_path());
    if (relative.empty() || *relative.begin() == "..")
        return Error(fmt::format("{}: '{}' lies outside its folder; copy it there first", file.string(), path.string()));
    return relative.generic_string();
}

std::string endingOf(const fs::path& path) {
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
    return ending;
}

}  // namespace fantascope
