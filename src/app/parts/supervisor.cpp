#include "app/parts/supervisor.h"

#include "app/parts/part.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <utility>

namespace fantascope::app {
namespace {

constexpr Time kLook = std::chrono::milliseconds(50);
constexpr Time kOnePress = std::chrono::milliseconds(500);                                       // signals within it count as one
constexpr Time kFirstPause = std::chrono::seconds(1), kLongestPause = std::chrono::seconds(30);  // between guards that die
constexpr Time kLampsWithin = std::chrono::seconds(1);  // for the next DMX frame, on a busy machine
constexpr unsigned kLastResort = 15;                    // s; then the program exits, even if leave() hangs, too

// Whether the file is a pipe, whose reader may go away.
bool isPipe(int file) {
    struct stat status {};
    return fstat(file, &status) == 0 && S_ISFIFO(status.st_mode);
}

bool isBroken(int file) {
    pollfd asked{file, 0, 0};
    return poll(&asked, 1, 0) > 0 && (asked.revents & POLLERR) != 0;
}

}  // namespace

Supervisor::Supervisor(const Interrupt& interrupt, RelayGuard* guard)
    : interrupt_(interrupt), guard_(guard), thread_([this](const std::stop_token& stop) {
          setThreadRank(Rank::Lighting);
          live(stop);
      }) {}

Supervisor::~Supervisor() {
    const std::lock_guard lock(mutex_);  // never acquired while leave() runs
    thread_.request_stop();
}

void Supervisor::attend(Run run) {
    const std::lock_guard lock(mutex_);
    run_ = std::move(run);
    isSettingUp_ = false;
    if (began_) endRun();
}

void Supervisor::release() {
    const std::lock_guard lock(mutex_);
    run_.reset();
}

void Supervisor::step(std::string doing, Time patience) {
    const std::lock_guard lock(mutex_);
    doing_ = std::move(doing);
    since_ = clock_.now();
    patience_ = patience;
}

void Supervisor::advance() {
    const std::lock_guard lock(mutex_);
    since_ = clock_.now();
}

// If the run's end fails, it is called again at the next look.
void Supervisor::endRun() {
    if (!run_ || endIsTold_) return;
    run_->end();
    endIsTold_ = true;
}

std::optional<std::string> Supervisor::hung(Time now) const {
    if (!began_) return std::nullopt;
    const bool mayLeave = !run_ || run_->ended() || now - *began_ > kSafeWithin;
    if (pressedAgain_ && mayLeave) return "it was interrupted again while " + doing_;
    if (now - std::max(*began_, since_) < patience_) return std::nullopt;
    return fmt::format("it hung while {}", doing_);
}

bool Supervisor::outputIsRead() {
    return std::ranges::none_of(std::array{STDOUT_FILENO, STDERR_FILENO},
                                [](int file) { return isPipe(file) && isBroken(file); });
}

void Supervisor::keepGuard(Time now) {
    if (guard_ == nullptr || now < nextGuard_ || !guard_->hasDied()) return;
    const auto restarted = guard_->restart();
    guardPause_ = std::clamp(2 * guardPause_, kFirstPause, kLongestPause);
    nextGuard_ = now + guardPause_;
    const std::lock_guard lock(mutex_);
    if (run_) run_->tellGuardDied(restarted);  // without a run, no relay was switched yet, or everything has been reported
}

// Writes to the terminal directly: there is no status line yet, and a hanging X server answers no
// call.
void Supervisor::tellOfSlowSetUp(Time now) {
    if (!isSettingUp_ || doing_.empty() || now - since_ < patience_) return;
    isSettingUp_ = false;  // reported only once
    std::fputs(fmt::format("fantascope: still {}; lamps and relays wait for that. Ctrl-C ends\n", doing_).c_str(), stderr);
}

void Supervisor::live(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        pollfd request{ending() ? -1 : interrupt_.file(), POLLIN, 0};
        const timespec patience{0, kLook.count()};
        ppoll(&request, 1, &patience, nullptr);
        try {
            look(stop);
            failureTold_ = false;
        } catch (const std::exception& failure) {  // there may be memory again at the next look
            if (std::exchange(failureTold_, true)) continue;
            std::fputs("\nfantascope: error: the supervisor failed: ", stderr);
            std::fputs(failure.what(), stderr);
            std::fputs("\n", stderr);
        }
    }
}

void Supervisor::look(const std::stop_token& stop) {
    const Time now = clock_.now();
    keepGuard(now);
    if (!outputIsRead()) requested_ = true;
    const std::lock_guard lock(mutex_);
    if (!ending()) {
        tellOfSlowSetUp(now);
        return;
    }
    if (stop.stop_requested()) return;
    if (!began_) began_ = now;
    // Some parent programs pass on a signal that this program has received directly as well.
    if (interrupt_.count() > std::exchange(signals_, interrupt_.count()) && now - *began_ > kOnePress) pressedAgain_ = true;
    if (const auto why = hung(now)) leave(*why);
    endRun();
}

void Supervisor::leave(const std::string& why) {
    signal(SIGALRM, [](int) { _exit(1); });
    alarm(kLastResort);
    if (run_) {
        run_->hurry();  // most fixtures hold the last levels that they received
        const Time latest = std::max(*began_ + kSafeWithin, clock_.now() + kLampsWithin);
        while (!run_->ended() && clock_.now() < latest) clock_.sleepUntil(clock_.now() + std::chrono::milliseconds(5));
        run_->close();
        run_->tell(why);
    } else {
        std::fputs(fmt::format("\nfantascope: error: the show was to end, but {}\n", why).c_str(), stderr);
    }
    _exit(1);
}

}  // namespace fantascope::app
