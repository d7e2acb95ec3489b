#pragma once
// Plain logs for those who look for a cause. What an operator or a test cares about is a status or
// a report, never a log line.

#include <string_view>

namespace fantascope::log {

enum class Level { Debug, Info, Warning, Error };

// One line to standard error: time, level, category (the module's folder name), message. Lines
// below the category's level are dropped. Never waits for whoever reads standard error: a line that
// a held terminal or a full pipe does not take at once is lost, and the next one that it takes says
// so. Nothing is kept back, so that a program's last words are out when it ends.
// Thread: thread-safe; never on the render thread in steady state.
void write(Level level, std::string_view category, std::string_view message);

inline void debug(std::string_view category, std::string_view message) { write(Level::Debug, category, message); }
inline void info(std::string_view category, std::string_view message) { write(Level::Info, category, message); }
inline void warning(std::string_view category, std::string_view message) { write(Level::Warning, category, message); }
inline void error(std::string_view category, std::string_view message) { write(Level::Error, category, message); }

// The least level that is written; Info at the start.
void setLevel(Level level);
void setLevel(std::string_view category, Level level);

}  // namespace fantascope::log
