#include "drivers/display/monitor_watch.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <exception>
#include <utility>

namespace fantascope::drivers {
namespace {

constexpr int kRetry = 1000;  // ms

std::string whatOf(const std::exception_ptr& failure) {
    try {
        std::rethrow_exception(failure);
    } catch (const std::exception& known) {
        return known.what();
    } catch (...) {
        return "an exception of unknown kind";
    }
}

}  // namespace

Result<std::shared_ptr<MonitorWatch>> MonitorWatch::shared() {
    static std::mutex mutex;
    static std::weak_ptr<MonitorWatch> open;
    const std::lock_guard lock(mutex);
    if (auto watch = open.lock()) return watch;
    auto screen = TRY(XScreen::open());
    const int wake = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (wake < 0) return Error("no file descriptor is left; close other programs or raise the limit (ulimit -n)");
    std::shared_ptr<MonitorWatch> watch(new MonitorWatch(std::move(screen), wake));
    open = watch;
    return watch;
}

MonitorWatch::MonitorWatch(std::unique_ptr<XScreen> screen, int wake) : screen_(std::move(screen)), wake_(wake) {
    thread_ = std::thread([this] { run(); });
}

MonitorWatch::~MonitorWatch() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    wake();
    thread_.join();
    ::close(wake_);
}

void MonitorWatch::wake() { (void)::eventfd_write(wake_, 1); }

std::unique_ptr<MonitorWatch::Claim> MonitorWatch::claim(MonitorClaim what) {
    std::unique_lock lock(mutex_);
    const int number = placement_.add(std::move(what));
    wake();
    looked_.wait(lock, [&] { return seats_.contains(number); });
    return std::unique_ptr<Claim>(new Claim(shared_from_this(), number));
}

MonitorWatch::Claim::~Claim() {
    const std::lock_guard lock(watch_->mutex_);
    watch_->placement_.remove(number_);
    watch_->seats_.erase(number_);
}

Placement::Seat MonitorWatch::Claim::seat() const {
    const std::lock_guard lock(watch_->mutex_);
    return watch_->seats_.at(number_);
}

void MonitorWatch::Claim::tryAgain() {
    const std::lock_guard lock(watch_->mutex_);
    watch_->placement_.retry();
    watch_->wake();
}

void MonitorWatch::publish() {
    seats_ = placement_.seats();
    looked_.notify_all();
}

// Checks again after each request, because a driver may do something else.
void MonitorWatch::settle() {
    constexpr int kRounds = 5;
    screen_->keepAwake();
    for (int round = 1;; ++round) {
        const bool last = round == kRounds;
        const auto monitors = screen_->monitors();
        if (!monitors && !last) continue;
        if (!monitors) return deny(monitors.error().message(), Whom::NewClaims);
        Placement::Plan plan;
        {
            const std::lock_guard lock(mutex_);
            plan = placement_.look(*monitors, screen_->largest());
            if (plan.changes.empty() || last) publish();
        }
        const auto grown = screen_->grow(plan.screen);
        if (plan.changes.empty() || last) return;
        for (const Placement::Change& change : plan.changes) {
            const auto applied = grown ? screen_->apply(change) : XScreen::Applied::Refused;
            const std::lock_guard lock(mutex_);
            if (!grown) placement_.refused(change.claim, grown.error().message());
            if (applied == XScreen::Applied::TooLate) placement_.retry();
        }
    }
}

void MonitorWatch::deny(const std::string& why, Whom whom) {
    const std::lock_guard lock(mutex_);
    for (const auto& [number, seat] : placement_.seats()) {
        if (whom == Whom::NewClaims && seats_.contains(number)) continue;
        seats_[number] = {why, {}, 0};
    }
    looked_.notify_all();
}

bool MonitorWatch::ending() {
    const std::lock_guard lock(mutex_);
    return ending_;
}

bool MonitorWatch::wait(int file, int milliseconds) {
    std::array<pollfd, 2> ready = {{{wake_, POLLIN, 0}, {file, POLLIN, 0}}};
    (void)::poll(ready.data(), ready.size(), milliseconds);
    eventfd_t wakes = 0;
    return ::eventfd_read(wake_, &wakes) == 0;
}

std::string MonitorWatch::follow() {
    for (bool asked = true; !ending();) {
        const auto changed = screen_->changed();
        if (!changed) return changed.error().message();
        if (!*changed && !asked) {
            asked = wait(screen_->fileDescriptor(), -1);
            continue;
        }
        asked = false;
        settle();  // its replies may have brought events
    }
    return {};
}

// An exception is as good as the end of the connection: it is opened anew. What failed is said
// then, because there may be no memory for it now.
void MonitorWatch::run() {
    std::exception_ptr failure;
    while (!ending()) {
        try {
            if (failure) deny("the monitors cannot be looked at: " + whatOf(std::exchange(failure, nullptr)), Whom::All);
            attend();
        } catch (...) {
            failure = std::current_exception();
            loseScreen();
            wait(-1, kRetry);
        }
    }
}

void MonitorWatch::loseScreen() {
    screen_.reset();
    const std::lock_guard lock(mutex_);
    placement_.restart();
}

void MonitorWatch::attend() {
    while (!ending()) {
        if (!screen_) {
            if (auto opened = XScreen::open())
                screen_ = std::move(opened).value();
            else
                deny(opened.error().message(), Whom::All);
        } else if (const std::string gone = follow(); !gone.empty()) {
            deny(gone, Whom::All);
            loseScreen();
        }
        if (!screen_) wait(-1, kRetry);
    }
}

}  // namespace fantascope::drivers
