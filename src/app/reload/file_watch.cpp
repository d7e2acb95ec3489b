#include "app/reload/file_watch.h"

#include <system_error>
#include <utility>

namespace fantascope::app {

FileWatch::Stamp FileWatch::stampOf(const std::filesystem::path& file) {
    std::error_code written, sized;
    const Stamp stamp{std::filesystem::last_write_time(file, written), std::filesystem::file_size(file, sized), true};
    return written || sized ? Stamp() : stamp;
}

void FileWatch::watch(const std::set<std::filesystem::path>& files) {
    std::map<std::filesystem::path, Watched> watched;
    for (const std::filesystem::path& file : files) {
        const Stamp now = stampOf(file);
        const auto before = files_.find(file);
        watched[file] = before != files_.end() ? before->second : Watched{now, now};
    }
    files_ = std::move(watched);
}

std::set<std::filesystem::path> FileWatch::saved() {
    std::set<std::filesystem::path> saved;
    for (auto& [file, watched] : files_) {
        const Stamp now = stampOf(file);
        const bool isQuiet = std::exchange(watched.seen, now) == now;
        if (!isQuiet || !now.isThere || now == watched.known) continue;
        watched.known = now;
        saved.insert(file);
    }
    return saved;
}

}  // namespace fantascope::app
