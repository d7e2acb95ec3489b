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

// The thread of one real device, and the device's status. The driver passes a function that runs
// one life of the device, from opening it to losing it. The service calls it again and again, with
// pauses that grow from kMinPause to kMaxPause; wake() ends a pause.
//
//     Outage MyDriver::runOnce(Service& service) {
//         if (cannot be opened) return whyNotOpened(path, errno);
//         service.setRunning();
//         while (!service.ending()) {
//             ...
//             if (lost) return {DeviceState::Absent, "it was unplugged"};
//             service.wait(...);
//         }
//         return {};  // ending: nobody reads this
//     }
//
// It is the driver's last member, so its thread ends before anything that the thread uses is
// destroyed.
class Service {
public:
    using RunOnce = std::function<Outage(Service&)>;
    static constexpr Time kMinPause = std::chrono::milliseconds(50), kMaxPause = std::chrono::milliseconds(800);

    // The device is Starting until its first attempt has ended.
    Service(std::string name, std::string driver, LossAction onLoss, RunOnce runOnce);
    ~Service();  // returns after runOnce() has
    Service(const Service&) = delete;
    Service& operator=(const Service&) = delete;

    // From any thread. These never wait for the device.
    DeviceStatus status() const;
    bool isRunning() const { return running_; }
    // The error of a call while the device is not Running.
    Error refusal() const;
    // Ends a wait(), or the pause before the next attempt.
    void wake();

    // For runOnce(), on the service's thread.
    void setRunning();                  // the device is open and works
    void setTrouble(std::string what);  // what a running device fails to do; "" or a loss clears it
    bool ending() const { return ending_; }
    // Waits until one of `files` is readable or has failed, wake() is called, or `timeout` has
    // passed. Returns at once while the service is ending. Returns whether a file is ready.
    bool wait(Time timeout, std::initializer_list<int> files = {});

private:
    void run();

    const RunOnce runOnce_;
    mutable std::mutex mutex_;
    DeviceStatus status_;
    std::atomic<bool> running_ = false, ending_ = false;
    FileHandle wakeFile_;  // an eventfd, readable after wake()
    std::thread thread_;
};

}  // namespace fantascope::drivers
