#pragma once

#include "drivers/display/cable.h"
#include "drivers/display/glfw_library.h"
#include "drivers/display/refresh_train.h"
#include "drivers/surroundings.h"

#include "device/display_sink.h"

#include "core/config.h"

#include <memory>
#include <mutex>
#include <string>

struct GLFWwindow;

namespace fantascope::drivers {

// A window on the desktop, or a whole monitor or projector of the X server.
//
// It is Absent without an X server, without its monitor, and after somebody closed its window. The first two are tried again once
// a second, at makeCurrent(); a closed window stays closed until the program's next start, because somebody wanted it closed.
// The context and what is in it outlive the loss of a monitor. When the X server itself ends, Xlib ends the program.
// Refreshes: those of the monitor where swapping waits for them; elsewhere (as in Xvfb) those of the clock.
// Thread: the render thread must be the main thread, to which GLFW belongs. All GLFW displays of a program share it.
class GlfwDisplay final : public DisplaySink {
public:
    // Keys: monitor. Error: a wrong key.
    static Result<std::unique_ptr<DisplaySink>> open(const ConfigNode& options, const DisplayRequest& request,
                                                     const Surroundings& around);
    ~GlfwDisplay() override;

    DeviceStatus status() const override;
    glm::ivec2 size() const override { return request_.size; }
    double refreshRate() const override { return refreshes_.hertz(); }
    std::int64_t nextRefresh() const override;
    Time refreshTime(std::int64_t number) const override { return refreshes_.timeOf(number); }
    Result<void> makeCurrent() override;
    // 0 before it is Running for the first time.
    unsigned framebuffer() const override { return framebuffer_; }
    Result<Shown> present() override;
    Result<Shown> presentWith(Time leading) override;

private:
    GlfwDisplay(const DisplayRequest& request, const Surroundings& around, std::string monitor);

    // Makes it Running, the first time or again. Error: what is missing and what to do about it.
    Result<void> appear();
    // Why the window that was there shows nothing now; empty if it shows.
    std::string lossOfWindow() const;
    // Sees that it is Running, and brings it back when that is due. Error: it is Absent.
    Result<void> beThere();
    void setAbsence(const std::string& why);
    // Brings what was drawn into the window's back buffer, finished. Error: it is Absent.
    Result<void> fillBackBuffer();
    // Swaps after so many refreshes: 1 waits for the next where the driver can, 0 swaps at once.
    void swap(int refreshes);

    const DisplayRequest request_;
    const std::string monitor_;  // its name; empty: a window of the desktop
    Clock& clock_;
    Cable cable_;
    RefreshTrain refreshes_;
    std::shared_ptr<GlfwLibrary> glfw_;
    GLFWwindow* window_ = nullptr;
    unsigned framebuffer_ = 0;
    int swapInterval_ = -1;  // not set yet
    Time retryAt_{};

    mutable std::mutex mutex_;                       // status() reads what the render thread writes:
    std::string absence_ = "it was not opened yet";  // empty: Running
    int losses_ = 0;
};

}  // namespace fantascope::drivers
