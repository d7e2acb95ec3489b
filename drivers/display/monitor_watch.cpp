#include "drivers/display/monitor_watch.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <utility>

namespace fantascope::drivers {

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

// What was asked for is looked at, too: a driver may do something else.
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

void MonitorWatch::run() {
    for (bool asked = true, gone = false;;) {
        {
            const std::lock_guard lock(mutex_);
            if (ending_) return;
        }
        const auto changed = screen_->changed();
        if (!changed) {
            gone = true;
            deny(changed.error().message(), Whom::All);
        } else if (*changed || asked) {
            asked = false;
            settle();
            continue;  // its answers may have brought events along
        }
        std::array<pollfd, 2> ready = {{{wake_, POLLIN, 0}, {gone ? -1 : screen_->fileDescriptor(), POLLIN, 0}}};
        (void)::poll(ready.data(), ready.size(), -1);
        eventfd_t wakes = 0;
        asked = ::eventfd_read(wake_, &wakes) == 0;
    }
}

}  // namespace fantascope::drivers
