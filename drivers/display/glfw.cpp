#include "drivers/display/glfw.h"

#include "drivers/display/srgb_framebuffer.h"

#include <epoxy/gl.h>

#define GLFW_INCLUDE_NONE  // epoxy brings OpenGL
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

namespace fantascope::drivers {
namespace {

constexpr const char* kDriver = "glfw";
constexpr Time kRetry = std::chrono::seconds(1);
// A swap that takes more than this part of a period waited for a refresh; one that takes less only copied.
constexpr double kWaitOfSwap = 0.25;

// A monitor, and the mode in which it shows a picture pixel by pixel.
struct Screen {
    GLFWmonitor* monitor;
    GLFWvidmode mode;
};

// Of the monitor's modes of the asked size the one nearest to the asked rate. Error: no such monitor (lists those there are), or
// it has no mode of that size.
Result<Screen> screenNamed(const std::string& name, const DisplayRequest& request) {
    int count = 0;
    GLFWmonitor** const monitors = glfwGetMonitors(&count);
    std::vector<std::string> names;
    for (int i = 0; i < count; ++i) {
        names.emplace_back(glfwGetMonitorName(monitors[i]));
        if (names.back() != name) continue;

        int modeCount = 0;
        const GLFWvidmode* const modes = glfwGetVideoModes(monitors[i], &modeCount);
        const GLFWvidmode* best = nullptr;
        const auto misses = [&](const GLFWvidmode& mode) { return std::abs(mode.refreshRate - request.refreshRate); };
        for (const GLFWvidmode* mode = modes; mode != modes + modeCount; ++mode)
            if (glm::ivec2(mode->width, mode->height) == request.size && (best == nullptr || misses(*mode) < misses(*best)))
                best = mode;
        if (best != nullptr) return Screen{monitors[i], *best};
        return Error(fmt::format("monitor '{}' has no mode of {} x {} pixels; give the output a size that it has", name,
                                 request.size.x, request.size.y));
    }
    return Error(
        fmt::format("there is no monitor '{}' (there is: {}); connect it and switch it on", name, fmt::join(names, ", ")));
}

}  // namespace

Result<std::unique_ptr<DisplaySink>> GlfwDisplay::open(const ConfigNode& options, const DisplayRequest& request,
                                                       const Surroundings& around) {
    std::string driver, monitor;
    ConfigFields fields(options);
    fields.text("driver", driver);
    fields.optional().text("monitor", monitor);
    TRY(fields.finish());

    std::unique_ptr<GlfwDisplay> sink(new GlfwDisplay(request, around, std::move(monitor)));
    (void)sink->beThere();  // a missing device is no error: its status tells of it
    return std::unique_ptr<DisplaySink>(std::move(sink));
}

GlfwDisplay::GlfwDisplay(const DisplayRequest& request, const Surroundings& around, std::string monitor)
    : request_(request),
      monitor_(std::move(monitor)),
      clock_(around.clock),
      cable_(request, around),
      refreshes_(request.refreshRate),
      retryAt_(around.clock.now()) {}

GlfwDisplay::~GlfwDisplay() {
    if (window_ != nullptr) glfwDestroyWindow(window_);
}

DeviceStatus GlfwDisplay::status() const {
    DeviceStatus status = cable_.status(kDriver);
    const std::lock_guard lock(mutex_);
    status.losses += losses_;
    if (status.state == DeviceState::Running && !absence_.empty()) {
        status.state = DeviceState::Absent;
        status.detail = absence_;
    }
    return status;
}

std::int64_t GlfwDisplay::nextRefresh() const { return refreshes_.running(clock_.now()) + 1; }

Result<void> GlfwDisplay::appear() {
    if (!glfw_) glfw_ = TRY(GlfwLibrary::shared());
    glfwPollEvents();  // monitors come and go by events
    Screen screen{nullptr, {}};
    if (!monitor_.empty()) screen = TRY(screenNamed(monitor_, request_));
    if (window_ != nullptr) {
        glfwSetWindowMonitor(window_, screen.monitor, 0, 0, request_.size.x, request_.size.y, screen.mode.refreshRate);
        return {};
    }

    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    // As in the headless display: contexts of one kind can take turns on a thread.
    glfwWindowHint(GLFW_CONTEXT_CREATION_API, GLFW_EGL_CONTEXT_API);
    glfwWindowHint(GLFW_RESIZABLE, GLFW_FALSE);
    glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE);  // an output stays up while somebody works at another window
    if (screen.mode.refreshRate > 0) glfwWindowHint(GLFW_REFRESH_RATE, screen.mode.refreshRate);
    window_ = glfwCreateWindow(request_.size.x, request_.size.y, request_.name.c_str(), screen.monitor, nullptr);
    if (window_ == nullptr)
        return Error(
            fmt::format("no window with OpenGL 4.5: {}; update the graphics driver (in software: Debian's package "
                        "libgl1-mesa-dri)",
                        whyGlfwFailed()));
    if (screen.monitor != nullptr) glfwSetInputMode(window_, GLFW_CURSOR, GLFW_CURSOR_HIDDEN);
    // GLFW knows whole numbers of Hz: what was asked is nearer to the truth than its rounding (59.94 and 60).
    if (screen.mode.refreshRate > 0 && std::abs(screen.mode.refreshRate - request_.refreshRate) >= 1)
        refreshes_ = RefreshTrain(screen.mode.refreshRate);

    glfwMakeContextCurrent(window_);
    const auto framebuffer = makeSrgbFramebuffer(request_.size);
    if (!framebuffer) {
        glfwDestroyWindow(std::exchange(window_, nullptr));
        return framebuffer.error();
    }
    framebuffer_ = *framebuffer;
    return {};
}

std::string GlfwDisplay::lossOfWindow() const {
    if (glfwWindowShouldClose(window_)) return "its window was closed; start Fantascope again to show it";
    // GLFW takes a window off a monitor that vanishes.
    if (!monitor_.empty() && glfwGetWindowMonitor(window_) == nullptr)
        return fmt::format("monitor '{}' vanished; connect it and switch it on", monitor_);
    return "";
}

void GlfwDisplay::setAbsence(const std::string& why) {
    const std::lock_guard lock(mutex_);
    if (absence_.empty() && !why.empty()) ++losses_;
    absence_ = why;
}

Result<void> GlfwDisplay::beThere() {
    const Time now = clock_.now();
    const bool closed = window_ != nullptr && glfwWindowShouldClose(window_);
    if (absence_.empty()) {
        setAbsence(lossOfWindow());
        if (!absence_.empty()) {
            glfwHideWindow(window_);
            retryAt_ = now + kRetry;
        }
    } else if (!closed && now >= retryAt_) {
        retryAt_ = now + kRetry;
        const auto appeared = appear();
        setAbsence(appeared ? "" : appeared.error().message());
    }
    if (!absence_.empty()) return Error(fmt::format("{} is absent: {}", request_.name, absence_));
    return {};
}

Result<void> GlfwDisplay::makeCurrent() {
    TRY(cable_.check());
    TRY(beThere());
    glfwGetError(nullptr);  // forgets older ones
    glfwMakeContextCurrent(window_);
    const char* why = nullptr;
    if (glfwGetError(&why) != GLFW_NO_ERROR)
        return Error(fmt::format("{}: its OpenGL context cannot be used: {}; use one render thread", request_.name, why));
    return {};
}

Result<void> GlfwDisplay::fillBackBuffer() {
    TRY(makeCurrent());
    // With conversion off the stored values arrive as they are, whatever the window says of its own colours.
    const bool converting = glIsEnabled(GL_FRAMEBUFFER_SRGB);
    glDisable(GL_FRAMEBUFFER_SRGB);
    const auto [width, height] = std::pair(request_.size.x, request_.size.y);
    glBlitNamedFramebuffer(framebuffer_, 0, 0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    if (converting) glEnable(GL_FRAMEBUFFER_SRGB);
    glFinish();  // now only the swap itself can wait
    return {};
}

void GlfwDisplay::swap(int refreshes) {
    if (std::exchange(swapInterval_, refreshes) != refreshes) glfwSwapInterval(refreshes);
    glfwSwapBuffers(window_);
    glFinish();
}

Result<Shown> GlfwDisplay::present() {
    TRY(fillBackBuffer());
    const Time before = clock_.now();
    std::int64_t refresh = nextRefresh();
    swap(1);
    const Time after = clock_.now();
    glfwPollEvents();
    if (seconds(after - before) * refreshes_.hertz() > kWaitOfSwap) refresh = refreshes_.seen(after);
    const Shown shown{refresh, refreshTime(refresh)};
    clock_.sleepUntil(shown.at);
    return shown;
}

Result<Shown> GlfwDisplay::presentWith(Time leading) {
    TRY(fillBackBuffer());
    clock_.sleepUntil(leading);
    const std::int64_t refresh = refreshes_.running(clock_.now());
    swap(0);
    glfwPollEvents();
    return Shown{refresh, refreshTime(refresh)};
}

}  // namespace fantascope::drivers
