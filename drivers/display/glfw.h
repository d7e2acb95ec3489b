#pragma once

#include "drivers/common/surroundings.h"
#include "drivers/display/cable.h"
#include "drivers/display/glfw_library.h"
#include "drivers/display/monitor_watch.h"
#include "drivers/display/refresh_train.h"

#include "device/display_sink.h"

#include "core/bounded_queue.h"
#include "core/config.h"

#include <memory>
#include <mutex>
#include <optional>
#include <string>

struct GLFWwindow;

namespace fantascope::drivers {

// A window on the desktop, or a whole monitor or projector of the X server, known by its identity
// and switched on by MonitorWatch.
//
// It is Absent without an X server, without its monitor, and after somebody closed its window. It
// is back as soon as its monitor is; the X server, and what was refused, is tried again once a
// second, at poll(). A window that was closed by its button stays closed until the program's next
// start, because somebody wanted it closed.
// The context outlives the loss of a monitor. It is lost when the X server ends, closes the
// connection, or when another program destroys the window.
// Refreshes: those of the monitor where swapping waits for them, which is tried with some black
// frames when the first window appears; elsewhere (as in Xvfb) those of the clock, and the swap
// waits for it.
// Thread: the render thread must be the main thread, to which GLFW belongs. All GLFW displays of a
// program share it.
// An X server that ends may raise SIGPIPE there, of which the program must not die.
class GlfwDisplay final : public DisplaySink {
public:
    // Keys: monitor, position. Error: a wrong key.
    static Result<Opening<DisplaySink>> fromConfig(const ConfigNode& options, const DisplayRequest& request);
    // Which monitor it would claim; nothing: it would be a window of the desktop. Error: a wrong
    // key.
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
    // The window itself (0) where that can hold stored sRGB values, else a picture that finish()
    // copies there.
    unsigned framebuffer() const override { return framebuffer_; }
    Result<void> finish() override;
    Result<Shown> present() override;
    Result<Shown> presentWith(Time leading) override;
    std::optional<ScreenEvent> pollEvent() override { return events_.pop(); }

private:
    GlfwDisplay(const DisplayRequest& request, const Surroundings& around, std::optional<MonitorClaim> wanted);

    // Makes it Running, the first time or again. Error: what is missing and what to do about it.
    Result<void> appear();
    Result<void> makeWindow();
    void listen();
    // Brings the window to where its monitor is now. Error: it is nowhere.
    Result<void> moveToMonitor();
    // Goes where its monitor is now, or appears, where that is due: whether it is Running.
    bool takePlace();
    void setAbsence(const std::string& why);
    // What has taken its context along; nothing: it is there, or there is none.
    std::optional<std::string> whyLost() const;
    // Destroys what a lost context has left.
    void clearUp();
    // Makes its context current for a swap. Error: it is Absent.
    Result<void> beThere();
    struct Swap {
        Time done{};
        Time took{};
    };
    // Swaps after so many refreshes: 1 waits for the next where the driver can, 0 swaps at once.
    // Error: its context is lost.
    Result<Swap> swap(int refreshes);
    // Finds out whether swaps wait, if nobody did. A driver may say so and not do it, and a slow
    // swap alone proves nothing.
    Result<void> tryWhetherSwapsWait();

    const DisplayRequest request_;
    const std::optional<MonitorClaim> wanted_;  // nothing: a window of the desktop
    Clock& clock_;
    Cable cable_;
    RefreshTrain refreshes_;
    std::shared_ptr<GlfwLibrary> glfw_;
    std::unique_ptr<MonitorWatch::Claim> monitor_;
    Placement::Seat seat_;  // of the monitor as it was seen last
    GLFWwindow* window_ = nullptr;
    int context_ = 0;           // 0: none, or a lost one
    int contexts_ = 0;          // that there were so far
    bool closed_ = false;       // its window, by its button
    unsigned framebuffer_ = 0;  // 0: the window
    int swapInterval_ = -1;     // not set yet
    Time retryAt_{};
    glm::dvec2 pointer_{0.0};
    BoundedQueue<ScreenEvent, 256> events_;  // what does not fit is lost: nobody has asked for a long time

    mutable std::mutex mutex_;                       // status() reads what the render thread writes:
    std::string absence_ = "it was not opened yet";  // empty: Running
    int losses_ = 0;
};

}  // namespace fantascope::drivers
