#pragma once

#include "drivers/display/refresh_train.h"
#include "drivers/site/plug.h"
#include "drivers/surroundings.h"

#include "device/display_sink.h"

#include "core/config.h"

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

struct GLFWwindow;
struct GLFWmonitor;

namespace fantascope::drivers {

// A window, or all of a monitor, of the window system that DISPLAY names.
//
// Its refreshes are the monitor's own where swapping buffers waits for them; where it does not (an X server in memory, a driver
// told not to wait) they are those of the clock, as on the headless display. It is Absent while there is no window system, while
// the named monitor is not connected, and for kReopenAfter after somebody closed its window: a projector must not stay dark
// because of a key press. Its picture is kept in a framebuffer of its own, so that it can be read back whatever covers the
// window.
//
// Thread: GLFW serves one thread. The thread that opens the first window, the render thread, opens, uses and destroys all of
// them; nobody else may use GLFW. It need not be the program's main thread. Calls from another thread stop the program.
class GlfwDisplay final : public DisplaySink {
public:
    static constexpr Time kReopenAfter = std::chrono::seconds(2);

    // Keys: `monitor`, the name of the monitor to fill (GLFW's, which is RandR's: "HDMI-1"); without it a window of the asked
    // size. Error: a wrong key.
    static Result<std::unique_ptr<DisplaySink>> open(const ConfigNode& options, const DisplayRequest& request,
                                                     const Surroundings& around);
    ~GlfwDisplay() override;

    DeviceStatus status() const override;
    glm::ivec2 size() const override { return request_.size; }
    double refreshRate() const override { return refreshes_.hertz(); }
    std::int64_t nextRefresh() const override;
    Time refreshTime(std::int64_t number) const override { return refreshes_.timeOf(number); }
    Result<void> makeCurrent() override;
    unsigned framebuffer() const override { return framebuffer_; }
    Result<Shown> present(bool paced) override;

private:
    class Session;
    GlfwDisplay(const DisplayRequest& request, const Surroundings& around, std::string monitor);

    // Brings the picture onto its screen if it is not there. Error: why it cannot be there now and what to do.
    Result<void> appear();
    Result<void> openWindow();
    Result<GLFWmonitor*> wantedMonitor() const;  // null: a window is enough
    void show(GLFWmonitor* monitor);
    void hide();
    // Whether swapping buffers waits for the monitor's refreshes, of which there are `hertz` a second.
    bool swapWaits(double hertz);
    void swap(int interval);

    DisplayRequest request_;
    std::string monitorName_;  // empty: a window
    Clock& clock_;
    std::optional<site::Plug> plug_;
    std::thread::id thread_ = std::this_thread::get_id();

    std::shared_ptr<Session> session_;
    GLFWwindow* window_ = nullptr;
    unsigned framebuffer_ = 0;
    Time retryAt_{}, retryAfter_;  // when to look for a window system again, and how long to wait after that
    Time reopenAt_{};
    int swapInterval_ = -1;  // as set last; -1: never
    bool swapWaits_ = false;
    RefreshTrain refreshes_;

    mutable std::mutex statusMutex_;
    DeviceStatus status_;  // of the window; whether a simulated projector is plugged in comes on top
};

}  // namespace fantascope::drivers
