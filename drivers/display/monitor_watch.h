#pragma once

#include "drivers/display/placement.h"
#include "drivers/display/x_screen.h"

#include "core/result.h"

#include <glm/vec2.hpp>

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

namespace fantascope::drivers {

// Keeps each claimed monitor on and in its place (see Placement), and knows where it is. All that
// waits for the X server happens on a thread of its own, which the X server wakes when anything
// changes, so that no frame has to wait for a monitor that comes or goes. It lives as long as
// somebody has a claim; meanwhile the screen is not blanked. An X server that ends takes all seats
// along; once a second it is tried whether there is one again. Thread: thread-safe.
class MonitorWatch : public std::enable_shared_from_this<MonitorWatch> {
public:
    // The process's one. Error: there is no X server with RandR.
    static Result<std::shared_ptr<MonitorWatch>> shared();
    ~MonitorWatch();
    MonitorWatch(const MonitorWatch&) = delete;
    MonitorWatch& operator=(const MonitorWatch&) = delete;

    // Somebody's claim on a monitor, until its end.
    class Claim {
    public:
        ~Claim();
        Claim(const Claim&) = delete;
        Claim& operator=(const Claim&) = delete;
        // Where its monitor is now; never waits for the X server.
        Placement::Seat seat() const;
        // Looks again soon, and tries again what was refused. Never waits.
        void tryAgain();

    private:
        friend class MonitorWatch;
        Claim(std::shared_ptr<MonitorWatch> watch, int number) : watch_(std::move(watch)), number_(number) {}
        std::shared_ptr<MonitorWatch> watch_;
        int number_;
    };
    // Waits until it was tried to give the claim its monitor.
    std::unique_ptr<Claim> claim(MonitorClaim what);

private:
    MonitorWatch(std::unique_ptr<XScreen> screen, int wake);
    void run();
    void attend();
    // Follows the monitors until this X server ends or this object does. Why the X server ended.
    std::string follow();
    void settle();
    enum class Whom { NewClaims, All };
    void deny(const std::string& why, Whom whom);
    void publish();  // with the mutex
    void wake();
    // Sleeps until it is woken, `file` can be read (-1: none), or so many milliseconds are over
    // (-1: never). Whether it was woken.
    bool wait(int file, int milliseconds);
    bool ending();

    std::unique_ptr<XScreen> screen_;  // the thread's; null: the X server is gone
    int wake_;                         // a file descriptor (eventfd) that the thread waits for besides the X server's

    std::mutex mutex_;
    std::condition_variable looked_;
    Placement placement_;
    std::map<int, Placement::Seat> seats_;  // when all was done for the last time; of a new claim none yet
    bool ending_ = false;
    std::thread thread_;
};

}  // namespace fantascope::drivers
