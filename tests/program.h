#pragma once
// Runs the built program as a user would.

#include "scratch_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

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

// Runs fantascope with `arguments` in `folder`, with further environment variables, and waits for it.
inline Outcome runProgram(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                          const std::vector<std::pair<std::string, std::string>>& environment = {}) {
    const ScratchFolder captured;
    const std::string out = captured / "out", errors = captured / "errors";
    const pid_t child = ::fork();
    if (child == 0) {
        if (::chdir(folder.c_str()) != 0) ::_exit(127);
        for (const auto& [name, value] : environment) ::setenv(name.c_str(), value.c_str(), 1);
        ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
        ::dup2(::open(out.c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
        ::dup2(::open(errors.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
        std::vector<char*> words{const_cast<char*>(FANTASCOPE_PROGRAM)};
        for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
        words.push_back(nullptr);
        ::execv(FANTASCOPE_PROGRAM, words.data());
        ::_exit(127);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), contentsOf(out), contentsOf(errors)};
}

}  // namespace fantascope
