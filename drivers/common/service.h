#pragma once

#include "drivers/common/file_handle.h"

#include "device/status.h"

#include "core/clock.h"
#include "core/result.h"

#include <atomic>
#include <functional>
#include <initializer_list>
#include <mutex>
#include <string>
#include <thread>

namespace fantascope::drivers {

// The thread that attends to one real device, and what the device says of itself. A driver hands it
// one function that lives through one life of the device; the service calls it again and again,
// with a back-off from kSoonest to kLatest between, at once when called. An exception is an outage.
//
//     Outage MyDriver::attend(Service& service) {
//         if (cannot be opened) return whyNotOpened(path, errno);
//         service.running();
//         while (!service.ending()) { ... if (lost) return {DeviceState::Absent, "it was unplugged"}; ... service.wait(...); }
//         return {};  // the farewell was said; nobody reads it
//     }
//
// It is the driver's last member, so that the thread has ended before anything that it uses goes.
class Service {
public:
    using Attend = std::function<Outage(Service&)>;
    static constexpr Time kSoonest = std::chrono::milliseconds(50), kLatest = std::chrono::milliseconds(800);

    // Until its first attempt has ended the device is Starting.
    Service(std::string name, std::string driver, LossAction onLoss, Attend attend);
    ~Service();  // returns when attend() has
    Service(const Service&) = delete;
    Service& operator=(const Service&) = delete;

    // From any thread; never wait for the device.
    DeviceStatus status() const;
    bool isRunning() const { return running_; }
    // The error of a call while the device is not Running.
    Error refusal() const;
    // Ends a wait() or the pause before the next attempt: there is something to do.
    void call();

    // For attend(), on the service's thread.
    void running();                  // the device is found, opened and does its work from now on
    void trouble(std::string what);  // of a device that is running, until it is over ("") or the device is lost
    bool ending() const { return ending_; }
    // Waits until one of `files` can be read (or has failed), it was called, or `patience` is over.
    // Returns at once when it is ending. Whether a file is ready.
    bool wait(Time patience, std::initializer_list<int> files = {});

private:
    void run();

    const Attend attend_;
    mutable std::mutex mutex_;
    DeviceStatus status_;
    std::atomic<bool> running_ = false, ending_ = false;
    FileHandle bell_;  // an eventfd: readable since it was called
    std::thread thread_;
};

}  // namespace fantascope::drivers
