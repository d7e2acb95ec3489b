#pragma once

#include "drivers/common/file_handle.h"

#include "core/check.h"
#include "program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace fantascope {

// Fantascope beside the test, and what it says line by line.
class RunningProgram {
public:
    RunningProgram(const std::vector<std::string>& arguments, const std::filesystem::path& folder) {
        int said[2];
        FANTASCOPE_CHECK(::pipe2(said, O_CLOEXEC) == 0, "there are pipes");
        process_ = ::fork();
        if (process_ == 0) {
            ::prctl(PR_SET_PDEATHSIG, SIGKILL);
            if (::chdir(folder.c_str()) != 0) ::_exit(127);
            ::dup2(::open("/dev/null", O_RDWR), STDIN_FILENO);
            ::dup2(STDIN_FILENO, STDOUT_FILENO);
            ::dup2(said[1], STDERR_FILENO);
            execute(arguments);
        }
        ::close(said[1]);
        said_ = drivers::FileHandle(said[0]);
    }
    ~RunningProgram() {
        if (process_ < 0) return;
        ::kill(process_, SIGKILL);
        ::waitpid(process_, nullptr, 0);
    }

    // Its next line; nothing: it has said none for half a minute, or has ended.
    std::optional<std::string> line() {
        for (std::size_t end = 0; (end = text_.find('\n')) == std::string::npos;) {
            pollfd something{said_.get(), POLLIN, 0};
            char bytes[4096];
            const ssize_t count = ::poll(&something, 1, 30'000) > 0 ? ::read(said_.get(), bytes, sizeof bytes) : 0;
            if (count <= 0) return std::nullopt;
            text_.append(bytes, static_cast<std::size_t>(count));
        }
        std::string line = text_.substr(0, text_.find('\n'));
        text_.erase(0, line.size() + 1);
        all_ += line + '\n';
        return line;
    }
    const std::string& all() const { return all_; }
    // Its status after a signal that asks it to end; SIGKILL's where it has not ended half a minute
    // after its last line.
    int stop(int signal = SIGINT) {
        ::kill(process_, signal);
        while (line()) continue;
        const drivers::FileHandle end(static_cast<int>(::syscall(SYS_pidfd_open, process_, 0)));
        pollfd ended{end.get(), POLLIN, 0};
        if (::poll(&ended, 1, 30'000) == 0) ::kill(process_, SIGKILL);
        int status = 0;
        ::waitpid(std::exchange(process_, -1), &status, 0);
        return statusOf(status);
    }

    std::ptrdiff_t countOf(const char* what) const {
        return std::distance(std::filesystem::directory_iterator(fmt::format("/proc/{}/{}", process_, what)),
                             std::filesystem::directory_iterator());
    }
    // What each of its open files is, by number; what is closed meanwhile is left out.
    std::map<int, std::string> openFiles() const {
        std::map<int, std::string> files;
        for (const auto& entry : std::filesystem::directory_iterator(fmt::format("/proc/{}/fd", process_))) {
            std::error_code closed;
            const std::filesystem::path file = std::filesystem::read_symlink(entry, closed);
            if (closed) continue;
            const std::string name = file.string();
            const bool socket = name.starts_with("socket:[");
            files.emplace(std::stoi(entry.path().filename()), socket ? nameOfSocket(name.substr(8, name.size() - 9)) : name);
        }
        return files;
    }
    // The kernel's line about a socket: its kind, and its addresses or its path.
    std::string nameOfSocket(const std::string& inode) const {
        for (const char* kind : {"unix", "tcp", "tcp6", "udp", "udp6", "netlink", "packet", "raw"}) {
            std::ifstream table(fmt::format("/proc/{}/net/{}", process_, kind));
            for (std::string line; std::getline(table, line);)
                if ((' ' + line + ' ').find(' ' + inode + ' ') != std::string::npos) return fmt::format("{}: {}", kind, line);
        }
        return "socket " + inode;
    }
    // Memory that is its own, in KiB.
    long kibibytes() const {
        std::ifstream rollup(fmt::format("/proc/{}/smaps_rollup", process_));
        std::string word;
        for (long number = 0; rollup >> word;)
            if (word == "Anonymous:" && rollup >> number) return number;
        return 0;
    }

private:
    pid_t process_ = -1;
    drivers::FileHandle said_;
    std::string text_, all_;
};

}  // namespace fantascope
