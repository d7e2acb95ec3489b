#include "drivers/common/service.h"

#include "core/check.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <exception>
#include <utility>
#include <vector>

namespace fantascope::drivers {

Service::Service(std::string name, std::string driver, LossAction onLoss, Attend attend)
    : attend_(std::move(attend)), bell_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    FANTASCOPE_CHECK(bell_.isOpen(), "a program has room for one more file");
    status_ = {std::move(name), std::move(driver), DeviceState::Starting, onLoss, "it is being looked for", 0};
    thread_ = std::thread([this] { run(); });
}

Service::~Service() {
    ending_ = true;
    call();
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

void Service::call() {
    const std::uint64_t once = 1;
    [[maybe_unused]] const ssize_t written = write(bell_.get(), &once, sizeof once);  // full is called too
}

void Service::running() {
    const std::lock_guard lock(mutex_);
    status_.state = DeviceState::Running;
    status_.detail.clear();
    running_ = true;
}

void Service::trouble(std::string what) {
    const std::lock_guard lock(mutex_);
    status_.trouble = std::move(what);
}

bool Service::wait(Time patience, std::initializer_list<int> files) {
    if (ending_) return false;
    std::vector<pollfd> waited{{bell_.get(), POLLIN, 0}};
    for (const int file : files) waited.push_back({file, POLLIN, 0});
    const auto whole = std::chrono::duration_cast<std::chrono::seconds>(std::max(patience, Time::zero()));
    const timespec limit{whole.count(), (std::max(patience, Time::zero()) - whole).count()};
    if (ppoll(waited.data(), waited.size(), &limit, nullptr) <= 0) return false;
    std::uint64_t calls = 0;
    if (waited[0].revents != 0) [[maybe_unused]]
        const ssize_t count = read(bell_.get(), &calls, sizeof calls);
    return std::any_of(waited.begin() + 1, waited.end(), [](const pollfd& file) { return file.revents != 0; });
}

namespace {

// One life of the device.
Outage lifeOf(const Service::Attend& attend, Service& service) {
    try {
        return attend(service);
    } catch (const std::exception& failure) {
        return {DeviceState::Faulted, std::string("its driver failed: ") + failure.what()};
    } catch (...) {
        return {DeviceState::Faulted, "its driver failed"};
    }
}

}  // namespace

void Service::run() {
    for (Time pause = kSoonest; !ending_; pause = std::min(2 * pause, kLatest)) {
        Outage outage = lifeOf(attend_, *this);
        if (ending_) return;
        {
            const std::lock_guard lock(mutex_);
            if (status_.state == DeviceState::Running) {
                ++status_.losses;
                pause = kSoonest;
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
