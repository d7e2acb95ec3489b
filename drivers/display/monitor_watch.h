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

// Keeps each claimed monitor switched on and in its place (see Placement). A thread of its own does
// everything that waits for the X server, which wakes it at each change, so no frame waits for a
// monitor that comes or goes. It lives as long as somebody has a claim; meanwhile the screen does
// not blank. When the X server ends, all seats become absent; a new one is tried once a second.
// Thread: thread-safe.
class MonitorWatch : public std::enable_shared_from_this<MonitorWatch> {
public:
    // The process's only one. Error: there is no X server with RandR.
    static Result<std::shared_ptr<MonitorWatch>> shared();
    ~MonitorWatch();
    MonitorWatch(const MonitorWatch&) = delete;
    MonitorWatch& operator=(const MonitorWatch&) = delete;

    // A claim on a monitor, until it is destroyed.
    class Claim {
    public:
        ~Claim();
        Claim(const Claim&) = delete;
        Claim& operator=(const Claim&) = delete;
        // Where its monitor is now; never waits for the X server.
        Placement::Seat seat() const;
        // Checks again soon, and retries what was refused. Never waits.
        void tryAgain();

    private:
        friend class MonitorWatch;
        Claim(std::shared_ptr<MonitorWatch> watch, int number) : watch_(std::move(watch)), number_(number) {}
        std::shared_ptr<MonitorWatch> watch_;
        int number_;
    };
    // Waits until the first attempt to give the claim its monitor has ended.
    std::unique_ptr<Claim> claim(MonitorClaim what);

private:
    MonitorWatch(std::unique_ptr<XScreen> screen, int wake);
    void run();
    void attend();
    // Follows the monitors until the X server ends or this object is destroyed. Returns why the X
    // server ended.
    std::string follow();
    void settle();
    enum class Whom { NewClaims, All };
    void deny(const std::string& why, Whom whom);
    void publish();     // with the mutex held
    void loseScreen();  // until it is opened anew
    void wake();
    // Sleeps until wake() is called, `file` is readable (-1: none), or the time has passed (-1:
    // never). Returns whether it was woken.
    bool wait(int file, int milliseconds);
    bool ending();

    std::unique_ptr<XScreen> screen_;  // used only by the thread; null: the X server is gone
    int wake_;                         // an eventfd that wakes the thread

    std::mutex mutex_;
    std::condition_variable looked_;
    Placement placement_;
    std::map<int, Placement::Seat> seats_;  // as of the last complete check; a new claim has none yet
    bool ending_ = false;
    std::thread thread_;
};

}  // namespace fantascope::drivers
