#include "drivers/common/service.h"

#include "core/check.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <utility>
#include <vector>

namespace fantascope::drivers {

Service::Service(std::string name, std::string driver, LossAction onLoss, RunOnce runOnce)
    : runOnce_(std::move(runOnce)), wakeFile_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    FANTASCOPE_CHECK(wakeFile_.isOpen(), "no file descriptor is left");
    status_ = {std::move(name), std::move(driver), DeviceState::Starting, onLoss, "looking for it", 0};
    thread_ = std::thread([this] { run(); });
}

Service::~Service() {
    ending_ = true;
    wake();
    thread_.join();
}

DeviceStatus Service::status() const {
    const std::lock_guard lock(mutex_);
    return status_;
}

Error Service::refusal() const {
    const DeviceStatus now = status();
    return Error(now.name + " is " + nameOf(now.state) + (now.detail.empty() ? "" : ": " + now.detail));
}

void Service::wake() {
    const std::uint64_t once = 1;
    [[maybe_unused]] const ssize_t written = write(wakeFile_.get(), &once, sizeof once);  // a full counter wakes it, too
}

void Service::setRunning() {
    const std::lock_guard lock(mutex_);
    status_.state = DeviceState::Running;
    status_.detail.clear();
    running_ = true;
}

void Service::setTrouble(std::string what) {
    const std::lock_guard lock(mutex_);
    status_.trouble = std::move(what);
}

bool Service::wait(Time timeout, std::initializer_list<int> files) {
    if (ending_) return false;
    std::vector<pollfd> waited{{wakeFile_.get(), POLLIN, 0}};
    for (const int file : files) waited.push_back({file, POLLIN, 0});
    const auto whole = std::chrono::duration_cast<std::chrono::seconds>(std::max(timeout, Time::zero()));
    const timespec limit{whole.count(), (std::max(timeout, Time::zero()) - whole).count()};
    if (ppoll(waited.data(), waited.size(), &limit, nullptr) <= 0) return false;
    std::uint64_t calls = 0;
    if (waited[0].revents != 0) [[maybe_unused]]
        const ssize_t count = read(wakeFile_.get(), &calls, sizeof calls);
    return std::any_of(waited.begin() + 1, waited.end(), [](const pollfd& file) { return file.revents != 0; });
}

void Service::run() {
    for (Time pause = kMinPause; !ending_; pause = std::min(2 * pause, kMaxPause)) {
        Outage outage = runOnce_(*this);
        if (ending_) return;
        {
            const std::lock_guard lock(mutex_);
            if (status_.state == DeviceState::Running) {
                ++status_.losses;
                pause = kMinPause;
            }
            running_ = false;
            status_.state = outage.state;
            status_.detail = std::move(outage.why);
            status_.trouble.clear();
        }
        wait(pause);
    }
}

}  // namespace fantascope::drivers
