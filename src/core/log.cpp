#include "core/log.h"

#include "core/text.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spdlog/details/os.h>
#include <spdlog/sinks/ansicolor_sink.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace fantascope::log {
namespace {

spdlog::level::level_enum spdlogLevel(Level level) {
    switch (level) {
        case Level::Debug:
            return spdlog::level::debug;
        case Level::Info:
            return spdlog::level::info;
        case Level::Warning:
            return spdlog::level::warn;
        case Level::Error:
            return spdlog::level::err;
    }
    return spdlog::level::info;
}

// How many of `bytes` standard error accepts at once; -1: none. Its open file description is shared
// with other programs, so it stays blocking. Instead, a terminal or a pipe is opened again for each
// line.
ssize_t writeAtOnce(const char* bytes, std::size_t count) {
    struct stat status {};
    if (fstat(STDERR_FILENO, &status) != 0) return -1;
    if (S_ISSOCK(status.st_mode)) return send(STDERR_FILENO, bytes, count, MSG_DONTWAIT);
    if (!S_ISFIFO(status.st_mode) && !S_ISCHR(status.st_mode)) return ::write(STDERR_FILENO, bytes, count);
    const int own = open("/proc/self/fd/2", O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (own < 0) {  // owned by another user
        pollfd room{STDERR_FILENO, POLLOUT, 0};
        return poll(&room, 1, 0) > 0 ? ::write(STDERR_FILENO, bytes, count) : -1;
    }
    const ssize_t written = ::write(own, bytes, count);
    close(own);
    return written;
}

// Standard error as a file that never waits. Guarded by the sink's lock.
class Unwaiting {
public:
    FILE* file() { return file_; }

private:
    static ssize_t take(void* self, const char* bytes, std::size_t count) {
        auto& file = *static_cast<Unwaiting*>(self);
        const std::string news =
            file.lost_ == 0 ? "" : fmt::format("\n({} lines of the log were lost: nobody read them)\n", file.lost_);
        const std::string text = news + std::string(bytes, count);
        if (writeAtOnce(text.data(), text.size()) == static_cast<ssize_t>(text.size()))
            file.lost_ = 0;
        else
            ++file.lost_;  // also partly written lines
        return static_cast<ssize_t>(count);
    }
    int lost_ = 0;  // since the last complete line
    FILE* const file_ = fopencookie(this, "w", {.read = nullptr, .write = take, .seek = nullptr, .close = nullptr});
};

class Loggers {
public:
    spdlog::logger& of(std::string_view category) {
        const std::lock_guard lock(mutex_);
        auto found = loggers_.find(category);
        if (found == loggers_.end()) {
            auto logger = std::make_unique<spdlog::logger>(std::string(category), sink_);
            logger->set_pattern(wipe_ + std::string("%H:%M:%S.%e %^%l%$ %n: %v"));
            logger->set_level(level_);
            found = loggers_.emplace(std::string(category), std::move(logger)).first;
        }
        return *found->second;
    }
    void setLevel(spdlog::level::level_enum level) {
        const std::lock_guard lock(mutex_);
        level_ = level;
        for (auto& [category, logger] : loggers_) logger->set_level(level);
    }

private:
    std::mutex mutex_;
    Unwaiting standardError_;
    spdlog::sink_ptr sink_ = std::make_shared<spdlog::sinks::ansicolor_sink<spdlog::details::console_mutex>>(
        standardError_.file(), isatty(STDERR_FILENO) != 0 && spdlog::details::os::is_color_terminal()
                                   ? spdlog::color_mode::always
                                   : spdlog::color_mode::never);
    // Clears a status line on a terminal; whoever drew it draws it again.
    const char* const wipe_ = isatty(STDERR_FILENO) != 0 ? "\r\x1b[J" : "";
    spdlog::level::level_enum level_ = spdlog::level::info;
    std::map<std::string, std::unique_ptr<spdlog::logger>, std::less<>> loggers_;
};

Loggers& loggers() {
    static Loggers instance;
    return instance;
}

}  // namespace

void write(Level level, std::string_view category, std::string_view message) {
    loggers().of(category).log(spdlogLevel(level), "{}", printableLines(message));
}

void setLevel(Level level) { loggers().setLevel(spdlogLevel(level)); }

void setLevel(std::string_view category, Level level) { loggers().of(category).set_level(spdlogLevel(level)); }

}  // namespace fantascope::log
