#include "app/site/relay_guard.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string>

namespace fantascope::app {
namespace {

// A crash that dumps gigabytes, to a file or to the system's crash handler, would hold the relays'
// line for that time. 1 turns both off (core(5)).
void crashAtOnce() {
    rlimit limit{};
    getrlimit(RLIMIT_CORE, &limit);
    limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, 1);
    setrlimit(RLIMIT_CORE, &limit);
}

Error notStarted(int reason) { return Error("no relay guard can be started: " + drivers::systemMessage(reason)); }

// A file that only this program and its children can open.
Result<drivers::FileHandle> inMemory(std::string_view text) {
    drivers::FileHandle file(memfd_create("site", MFD_CLOEXEC));
    if (!file.isOpen()) return notStarted(errno);
    while (!text.empty()) {
        const ssize_t written = write(file.get(), text.data(), text.size());
        if (written < 0) return notStarted(errno);
        text.remove_prefix(static_cast<std::size_t>(written));
    }
    return file;
}

}  // namespace

Result<std::unique_ptr<RelayGuard>> RelayGuard::start(const show::Site& site, std::vector<int> held, std::string bank) {
    crashAtOnce();
    drivers::FileHandle text = TRY(inMemory(site.text));
    std::unique_ptr<RelayGuard> guard(new RelayGuard(site.file, std::move(text), std::move(held), std::move(bank)));
    TRY(guard->restart());
    return guard;
}

RelayGuard::~RelayGuard() {
    if (!armed_) dismiss();
}

void RelayGuard::arm() {
    const std::lock_guard lock(mutex_);
    armed_ = true;
}

bool RelayGuard::hasDied() const {
    const std::lock_guard lock(mutex_);
    pollfd far{pipe_.get(), 0, 0};  // poll() ignores a file of -1
    return !dismissed_ && (process_ < 0 || (poll(&far, 1, 0) > 0 && (far.revents & POLLERR) != 0));
}

Result<void> RelayGuard::restart() {
    const std::lock_guard lock(mutex_);
    if (dismissed_) return {};
    if (process_ > 0) waitpid(process_, nullptr, 0);
    process_ = -1;
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return notStarted(errno);
    const drivers::FileHandle far(ends[0]);
    pipe_ = drivers::FileHandle(ends[1]);

    // A session of its own, so that a terminal's signals to the run do not reach it. All signals
    // are blocked until it ignores them.
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t all;
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes, &all);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGMASK);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, far.get(), STDIN_FILENO);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    for (const int file : held_) posix_spawn_file_actions_adddup2(&files, file, file);  // onto itself: it stays open
    posix_spawn_file_actions_adddup2(&files, text_.get(), text_.get());
    std::string program = "/proc/self/exe", command = kGuardCommand, file = site_.string(), bank = "--bank=" + bank_,
                name = "fantascope";
    std::string text = "/proc/self/fd/" + std::to_string(text_.get());
    char* words[] = {name.data(), command.data(), file.data(), text.data(), bank_.empty() ? nullptr : bank.data(), nullptr};
    const int error = posix_spawn(&process_, program.c_str(), &files, &attributes, words, environ);
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
    if (error == 0) return {};
    process_ = -1;
    return notStarted(error);
}

void RelayGuard::dismiss() {
    const std::lock_guard lock(mutex_);
    if (std::exchange(dismissed_, true) || process_ < 0) return;
    constexpr std::string_view kWord = kAllIsSafe;
    [[maybe_unused]] const ssize_t written = write(pipe_.get(), kWord.data(), kWord.size());
    pipe_ = {};
    const drivers::FileHandle ended(static_cast<int>(syscall(SYS_pidfd_open, process_, 0)));
    pollfd waited{ended.get(), POLLIN, 0};
    if (poll(&waited, 1, 2000) > 0) waitpid(process_, nullptr, WNOHANG);
    process_ = -1;
}

}  // namespace fantascope::app
