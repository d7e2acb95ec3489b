#pragma once

#include "drivers/common/opening.h"
#include "drivers/display/cable.h"
#include "drivers/display/glfw_library.h"
#include "drivers/display/monitor_watch.h"
#include "drivers/display/refresh_train.h"
#include "drivers/display/screen_events.h"

#include "device/display_sink.h"

#include "core/config/config.h"

#include <memory>
#include <mutex>
#include <optional>
#include <string>

struct GLFWwindow;

namespace fantascope::drivers {

// A window on the desktop, or a whole monitor or projector of the X server. MonitorWatch finds the
// monitor by its identity and switches it on.
//
// It is Absent without an X server, without its monitor, or after somebody closed its window. It
// comes back as soon as its monitor does. In poll(), the X server and refused requests are retried
// once a second. A window that was closed by its button stays closed until the program restarts,
// because somebody wanted it closed.
// The context survives the loss of a monitor. It is lost when the X server ends or closes the
// connection, or when another program destroys the window.
// Refreshes: those of the monitor if swapping waits for them (vertical sync), which is measured
// with some black frames when the first window appears. Otherwise, as in Xvfb, those of the clock,
// and the swap waits for the clock.
// Thread: the render thread must be the main thread, which GLFW requires. All GLFW displays of a
// program share it.
// An X server that ends may raise SIGPIPE there, which must not end the program.
class GlfwDisplay final : public DisplaySink {
public:
    // Keys: monitor, position. Error: a wrong key.
    static Result<Opening<DisplaySink>> fromConfig(const ConfigNode& options, const DisplayRequest& request);
    // The monitor that it would claim; nothing: a window on the desktop. Error: a wrong key.
    static Result<std::optional<MonitorClaim>> claimOf(const ConfigNode& options, const DisplayRequest& request);
    ~GlfwDisplay() override;

    DeviceStatus status() const override;
    glm::ivec2 size() const override { return request_.size; }
    double refreshRate() const override { return refreshes_.hertz(); }
    std::int64_t nextRefresh() const override;
    Time refreshTime(std::int64_t number) const override { return refreshes_.timeOf(number); }
    bool poll() override;
    int context() const override { return context_; }
    Result<void> makeCurrent() override;
    void release() override;
    // The window itself (0) if it can hold stored sRGB values, else a picture that finish() copies
    // there.
    unsigned framebuffer() const override { return framebuffer_; }
    Result<void> finish() override;
    Result<Shown> present() override;
    Result<Shown> presentWith(Time leading) override;
    std::optional<ScreenEvent> pollEvent() override { return events_.take(); }

private:
    GlfwDisplay(const DisplayRequest& request, const DriverContext& driverContext, std::optional<MonitorClaim> wanted);

    // Makes it Running, at first or after a loss. Error: what is missing and what to do about it.
    Result<void> appear();
    Result<void> makeWindow();
    void installCallbacks();
    // Moves the window to its monitor. Error: there is no such monitor.
    Result<void> moveToMonitor();
    // Follows its monitor, or appears if it is time to retry. Returns whether it is Running.
    bool updatePlace();
    void setAbsence(const std::string& why);
    // Why the context was lost; nothing: it exists, or there never was one.
    std::optional<std::string> whyLost() const;
    // Destroys the remains of a lost context.
    void destroyRemains();
    // Makes its context current for a swap. Error: it is Absent.
    Result<void> ensureRunning();
    struct Swap {
        Time done{};
        Time took{};
    };
    // Swaps the buffers. refreshes = 1 waits for the next refresh if the driver can, 0 swaps at
    // once.
    // Error: its context is lost.
    Result<Swap> swap(int refreshes);
    // Measures whether swaps wait for refreshes, unless that is known. A driver may claim to wait
    // and not do it, and a single slow swap proves nothing.
    Result<void> probeVsync();

    const DisplayRequest request_;
    const std::optional<MonitorClaim> wanted_;  // nothing: a window on the desktop
    Clock& clock_;
    Cable cable_;
    RefreshTrain refreshes_;
    std::shared_ptr<GlfwLibrary> glfw_;
    std::unique_ptr<MonitorWatch::Claim> monitor_;
    Placement::Seat seat_;  // of its monitor, as last seen
    GLFWwindow* window_ = nullptr;
    int context_ = 0;           // 0: none, or lost
    int contexts_ = 0;          // made so far
    bool closed_ = false;       // by the window's button
    unsigned framebuffer_ = 0;  // 0: the window
    int swapInterval_ = -1;     // not set yet
    Time retryAt_{};
    glm::dvec2 pointer_{0.0};
    ScreenEvents events_;

    mutable std::mutex mutex_;                    // guards the following, which status() reads and the render thread writes
    std::string absence_ = "it is not open yet";  // empty: Running
    int losses_ = 0;
};

}  // namespace fantascope::drivers
