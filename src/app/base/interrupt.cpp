#include "app/base/interrupt.h"

#include "core/check.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>

namespace fantascope::app {
namespace {

constexpr int kAlways[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE};
constexpr int kOfShows[] = {SIGPWR, SIGUSR1, SIGUSR2};
constexpr int kStops[] = {SIGTSTP, SIGTTIN, SIGTTOU};  // a stopped show has not ended, so its guard would wait

// Lock-free, so a signal handler may write them.
std::atomic<int> signals = 0, first = 0, bell = -1;
std::atomic<bool> isShow = false;

// Whether somebody can still read the program's output. Safe in a signal handler.
bool isRead() {
    pollfd printed[] = {{STDOUT_FILENO, 0, 0}, {STDERR_FILENO, 0, 0}};
    return poll(printed, 2, 0) <= 0 || ((printed[0].revents | printed[1].revents) & (POLLERR | POLLHUP)) == 0;
}

void note(int signal, siginfo_t* info, void*) {
    const int error = errno;
    // A write to a peer that is gone, such as an X server or a module, does not ask for the end.
    // The Supervisor notices by itself if nobody reads the show's output any more.
    if (signal == SIGPIPE && info->si_pid == getpid() && (isShow || isRead())) {
        errno = error;
        return;
    }
    if (signals++ == 0) first = signal;
    const std::uint64_t once = 1;
    [[maybe_unused]] const ssize_t written = write(bell, &once, sizeof once);
    errno = error;
}

}  // namespace

Interrupt::Interrupt(Second second) {
    signals = first = 0;
    bell = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    FANTASCOPE_CHECK(bell >= 0, "a program has room for one more file");
    const bool counts = isShow = second == Second::IsCounted;
    const auto replace = [&](int signal) {
        struct sigaction before {
        }, action{};
        action.sa_sigaction = note;
        action.sa_flags = SA_SIGINFO | SA_RESTART | (counts || signal == SIGPIPE ? 0 : static_cast<int>(SA_RESETHAND));
        sigaction(signal, nullptr, &before);
        const bool ignored = (before.sa_flags & SA_SIGINFO) == 0 && before.sa_handler == SIG_IGN;
        if (ignored && (signal == SIGHUP || signal == SIGPIPE)) return;
        sigaction(signal, &action, nullptr);
        replaced_.push_back({signal, before});
    };
    for (const int signal : kAlways) replace(signal);
    if (!counts) return;
    for (const int signal : kOfShows) replace(signal);
    for (const int signal : kStops) {
        struct sigaction before {
        }, ignored{};
        ignored.sa_handler = SIG_IGN;
        sigaction(signal, &ignored, &before);
        replaced_.push_back({signal, before});
    }
}

Interrupt::~Interrupt() {
    for (const Replaced& replaced : replaced_) sigaction(replaced.signal, &replaced.before, nullptr);
    close(bell.exchange(-1));
}

int Interrupt::count() const { return signals; }

std::string Interrupt::name() const { return requested() ? std::string("SIG") + sigabbrev_np(first) : ""; }

int Interrupt::file() const { return bell; }

}  // namespace fantascope::app
