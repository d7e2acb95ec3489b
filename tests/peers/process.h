#pragma once
// Programs that run beside a test, which ends them in every way.

#include "drivers/common/file_handle.h"

#include "core/check.h"
#include "program.h"

#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::peers {

class Process {
public:
    Process() = default;
    // fantascope with these arguments; its output goes to a pipe. `prepare` is called last in its
    // process before exec.
    using Prepare = std::function<void()>;
    Process(const std::vector<std::string>& arguments, const std::filesystem::path& folder, const Prepare& prepare = {}) {
        start([&] {
            if (::chdir(folder.c_str()) != 0) ::_exit(127);
            ::signal(SIGHUP, SIG_DFL);
            ::signal(SIGPIPE, SIG_DFL);
            if (prepare) prepare();
            execute(arguments);
        });
    }
    // An X server with one screen; `display` is its name.
    static Process xServer(std::string& display) {
        Process server;
        server.start([] {
            const std::string number = std::to_string(STDOUT_FILENO);
            ::execlp("Xvfb", "Xvfb", "-screen", "0", "640x360x24", "-nolisten", "tcp", "-noreset", "-displayfd", number.c_str(),
                     nullptr);
            ::_exit(127);
        });
        while (server.said().find('\n') == std::string::npos)
            FANTASCOPE_CHECK(server.waitForWords(), "Xvfb does not start; install Debian's package xvfb");
        std::string::size_type end = server.all_.find_last_not_of('\n'), begin = server.all_.find_last_of('\n', end);
        display = ":" + server.all_.substr(begin + 1, end - begin);
        return server;
    }
    Process(Process&& other) noexcept
        : process_(std::exchange(other.process_, -1)), words_(std::move(other.words_)), all_(std::move(other.all_)) {}
    ~Process() {
        if (process_ < 0) return;
        signal(SIGKILL);
        wait();
    }

    pid_t id() const { return process_; }
    void signal(int number) const {
        if (process_ > 0) ::kill(process_, number);
    }
    // The same, and returns once the signal has reached the program, because two pending signals of
    // a kind become one.
    void signalAlone(int number) const {
        signal(number);
        const auto isPending = [&] {
            std::ifstream file(fmt::format("/proc/{}/status", process_));
            for (std::string word; file >> word;)
                if (unsigned long long pending = 0; word == "ShdPnd:" && file >> std::hex >> pending)
                    return (pending >> (number - 1) & 1) != 0;
            return false;
        };
        while (isPending() && isRunning()) ::sched_yield();  // the signal that ends a program stays pending
    }
    void stopReading() { words_ = {}; }
    bool isRunning() const {
        siginfo_t ended{};
        return ::waitid(P_PID, static_cast<id_t>(process_), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 && ended.si_pid == 0;
    }
    // Waits for its end: its status, or 128 + a signal.
    int wait() {
        int status = 0;
        ::waitpid(std::exchange(process_, -1), &status, 0);
        return statusOf(status);
    }
    // Its output so far.
    const std::string& said() {
        while (poll(0)) {
            char bytes[4096];
            const ssize_t count = ::read(words_.get(), bytes, sizeof bytes);
            if (count <= 0) break;
            all_.append(bytes, static_cast<std::size_t>(count));
        }
        return all_;
    }
    std::vector<pid_t> children() const {
        std::vector<pid_t> children;
        for (const auto& task : std::filesystem::directory_iterator(fmt::format("/proc/{}/task", process_))) {
            std::ifstream file(task.path() / "children");
            for (pid_t child = 0; file >> child;) children.push_back(child);
        }
        return children;
    }

private:
    void start(const std::function<void()>& become) {
        int ends[2];
        FANTASCOPE_CHECK(::pipe2(ends, O_CLOEXEC) == 0, "there are pipes");
        process_ = ::fork();
        FANTASCOPE_CHECK(process_ >= 0, "there are processes");
        if (process_ == 0) {
            ::prctl(PR_SET_PDEATHSIG, SIGKILL);
            ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
            ::dup2(ends[1], STDOUT_FILENO);
            ::dup2(ends[1], STDERR_FILENO);
            become();
        }
        ::close(ends[1]);
        words_ = drivers::FileHandle(ends[0]);
    }
    bool poll(int timeout) const {
        pollfd something{words_.get(), POLLIN, 0};
        return ::poll(&something, 1, timeout) > 0 && (something.revents & POLLIN) != 0;
    }
    bool waitForWords() const { return poll(30'000); }

    pid_t process_ = -1;
    drivers::FileHandle words_;
    std::string all_;
};

}  // namespace fantascope::peers
