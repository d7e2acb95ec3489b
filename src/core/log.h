#pragma once
// Plain logs for diagnosis. What an operator or a test needs is a status or a report, never a log
// line.

#include <string_view>

namespace fantascope::log {

enum class Level { Debug, Info, Warning, Error };

// Writes one line to standard error: time, level, category (the module's folder), message. Lines
// below the category's level are dropped. Never waits for the reader of standard error: a line that
// a stopped terminal or a full pipe does not accept at once is lost, and the next accepted line
// reports the loss. Nothing is buffered, so a program's last words are out when it ends.
// Thread: thread-safe; never on the render thread in steady state.
void write(Level level, std::string_view category, std::string_view message);

inline void debug(std::string_view category, std::string_view message) { write(Level::Debug, category, message); }
inline void info(std::string_view category, std::string_view message) { write(Level::Info, category, message); }
inline void warning(std::string_view category, std::string_view message) { write(Level::Warning, category, message); }
inline void error(std::string_view category, std::string_view message) { write(Level::Error, category, message); }

// The lowest level that is written; initially Info.
void setLevel(Level level);
void setLevel(std::string_view category, Level level);

}  // namespace fantascope::log
