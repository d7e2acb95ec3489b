#include "core/log.h"

#include "core/text.h"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

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
    spdlog::sink_ptr sink_ = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
    // On a terminal a status line may stand where this one comes; whoever drew it draws it again.
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
