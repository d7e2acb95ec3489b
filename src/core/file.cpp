#include "core/file.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>

namespace fantascope {

namespace fs = std::filesystem;

Result<std::string> readFile(const fs::path& path) { return readStart(path, std::numeric_limits<std::size_t>::max()); }

Result<std::string> readStart(const fs::path& path, std::size_t bytes) {
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) return Error(fmt::format("{}: is a folder, a file is needed", path.string()));
    std::ifstream stream(path, std::ios::binary);
    if (!stream) return Error(fmt::format("{}: cannot be read: {}", path.string(), std::strerror(errno)));
    std::string content;
    std::array<char, 65536> part;
    while (content.size() < bytes) {
        stream.read(part.data(), static_cast<std::streamsize>(std::min(part.size(), bytes - content.size())));
        content.append(part.data(), static_cast<std::size_t>(stream.gcount()));
        if (!stream) break;
    }
    if (stream.bad()) return Error(fmt::format("{}: reading failed: {}", path.string(), std::strerror(errno)));
    return content;
}

Result<void> writeFile(const fs::path& path, std::string_view bytes, const fs::path& like) {
    const auto refused = [&](int reason) {
        return Error(fmt::format("{}: cannot be written: {}", path.string(), std::strerror(reason)));
    };
    std::error_code failure;
    if (path.has_parent_path()) fs::create_directories(path.parent_path(), failure);
    if (failure) return refused(failure.value());

    std::error_code ignored;
    const fs::path target = fs::is_symlink(path, ignored) ? fs::canonical(path, failure) : path;
    if (failure) return refused(failure.value());  // a link to nowhere
    struct stat standing = {}, model = {};
    const bool stands = ::stat(target.c_str(), &standing) == 0;
    if (stands && ((standing.st_mode & 0222) == 0 || ::access(target.c_str(), W_OK) != 0)) return refused(EACCES);
    const bool modelled = ::stat(like.empty() ? target.c_str() : like.c_str(), &model) == 0;

    std::string aside = target.string() + ".XXXXXX";  // mkstemp(3) puts letters there that no file has yet
    const int descriptor = ::mkstemp(aside.data());
    if (descriptor < 0) return refused(errno);
    const auto abandon = [&](int reason) {
        ::close(descriptor);
        ::unlink(aside.c_str());
        return refused(reason);
    };
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return abandon(errno);
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    // Only root may give a file away, others may to a group of their own; where neither is allowed the file is the writer's.
    [[maybe_unused]] const bool given = modelled && (::fchown(descriptor, model.st_uid, model.st_gid) == 0 ||
                                                     ::fchown(descriptor, static_cast<uid_t>(-1), model.st_gid) == 0);
    if (::fchmod(descriptor, modelled ? model.st_mode & 0777 : 0644) != 0 || ::fsync(descriptor) != 0) return abandon(errno);
    if (::rename(aside.c_str(), target.c_str()) != 0) return abandon(errno);
    ::close(descriptor);
    return {};
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
