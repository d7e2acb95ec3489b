#pragma once
// Runs the built program as a user would.

#include "scratch_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace fantascope {

struct Outcome {
    int status = -1;  // the exit status, or 128 + the signal
    std::string out, errors;
};

inline std::string contentsOf(const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
}

// Becomes fantascope, or a copy of it, in a child process.
[[noreturn]] inline void execute(const std::vector<std::string>& arguments, const char* program = FANTASCOPE_PROGRAM) {
    std::vector<char*> words{const_cast<char*>(program)};
    for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    ::signal(SIGXFSZ, SIG_DFL);  // as a shell starts it, whatever the test itself ignores
    ::execv(program, words.data());
    ::_exit(127);
}

inline int statusOf(int waited) { return WIFEXITED(waited) ? WEXITSTATUS(waited) : 128 + WTERMSIG(waited); }

// Runs fantascope with `arguments` in `folder`, with further environment variables, and waits for
// it.
inline Outcome runProgram(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                          const std::vector<std::pair<std::string, std::string>>& environment = {},
                          const std::filesystem::path& program = FANTASCOPE_PROGRAM) {
    const ScratchFolder captured;
    const std::string out = captured / "out", errors = captured / "errors";
    const pid_t child = ::fork();
    if (child == 0) {
        if (::chdir(folder.c_str()) != 0) ::_exit(127);
        for (const auto& [name, value] : environment) ::setenv(name.c_str(), value.c_str(), 1);
        ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
        ::dup2(::open(out.c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
        ::dup2(::open(errors.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
        execute(arguments, program.c_str());
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    Outcome outcome{statusOf(status), contentsOf(out), contentsOf(errors)};
    // Its report is one of our faults whatever status the program was to end with.
    if (outcome.errors.find("Sanitizer") != std::string::npos) ADD_FAILURE() << outcome.errors;
    return outcome;
}

inline void PrintTo(const Outcome& outcome, std::ostream* out) {
    *out << fmt::format("a program that ended with {} and said:\n{}{}", outcome.status, outcome.out, outcome.errors);
}

// EXPECT_THAT(run(...), exits(0)) tells of a program that ended otherwise what it had said.
MATCHER_P(exits, status, fmt::format("{} with {}", negation ? "does not end" : "ends", status)) { return arg.status == status; }

// Runs fantascope with `arguments` in `folder`, presses Ctrl-C once it has told `lines` lines of
// progress, and waits for it: the exit status, or 128 + the signal; -1 if it ended before.
inline int interruptProgram(const std::vector<std::string>& arguments, const std::filesystem::path& folder, int lines) {
    int pipe[2];
    if (::pipe(pipe) != 0) return -1;
    const pid_t child = ::fork();
    if (child == 0) {
        if (::chdir(folder.c_str()) != 0) ::_exit(127);
        ::dup2(pipe[1], STDERR_FILENO);
        ::close(pipe[0]);
        execute(arguments);
    }
    ::close(pipe[1]);
    char byte = 0;
    while (lines > 0 && ::read(pipe[0], &byte, 1) == 1) lines -= byte == '\n';
    ::kill(child, SIGINT);
    int status = 0;
    ::waitpid(child, &status, 0);
    ::close(pipe[0]);
    return lines > 0 ? -1 : statusOf(status);
}

// Runs fantascope with `arguments` in `folder` on a terminal of its own and types: each key once
// the text before it has been read that often since the last key. The exit status, or 128 + the
// signal.
struct Typed {
    std::string after;
    int times;
    char key;
};
inline int typeAtProgram(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                         const std::vector<Typed>& typed) {
    int terminal = -1;
    const pid_t child = ::forkpty(&terminal, nullptr, nullptr, nullptr);
    if (child == 0) {
        if (::chdir(folder.c_str()) != 0) ::_exit(127);
        execute(arguments);
    }
    std::string read;
    auto next = typed.begin();
    char byte = 0;
    for (int times = 0; ::read(terminal, &byte, 1) == 1;) {  // fails once the program has ended
        read += byte;
        if (next == typed.end() || !read.ends_with(next->after) || ++times < next->times) continue;
        if (::write(terminal, &next->key, 1) != 1) break;
        ++next;
        times = 0;
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    ::close(terminal);
    return statusOf(status);
}

}  // namespace fantascope
