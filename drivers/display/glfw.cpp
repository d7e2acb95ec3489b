#include "drivers/display/glfw.h"

#include "drivers/display/srgb_framebuffer.h"

#include "core/check.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#define GLFW_INCLUDE_NONE
#define GLFW_EXPOSE_NATIVE_EGL
#include <GLFW/glfw3.h>
#include <GLFW/glfw3native.h>

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace fantascope::drivers {
namespace {

constexpr Time kFirstRetry = std::chrono::seconds(1), kLastRetry = std::chrono::seconds(30);

// What GLFW says of the call that failed last.
std::string glfwReason() {
    const char* reason = nullptr;
    glfwGetError(&reason);
    return reason != nullptr ? reason : "no reason given";
}

std::span<GLFWmonitor*> monitors() {
    int count = 0;
    GLFWmonitor** all = glfwGetMonitors(&count);
    return {all, static_cast<std::size_t>(count)};
}

}  // namespace

// GLFW between its first window and its last.
class GlfwDisplay::Session {
public:
    // Error: there is no window system.
    static Result<std::shared_ptr<Session>> shared() {
        static std::weak_ptr<Session> open;
        if (auto session = open.lock()) {
            FANTASCOPE_CHECK(session->thread_ == std::this_thread::get_id(), "all windows belong to one thread");
            return session;
        }
        if (!glfwInit())
            return Error(fmt::format("no window system: {}; start an X server and set DISPLAY, or use the headless display",
                                     glfwReason()));
        auto session = std::make_shared<Session>();
        open = session;
        return session;
    }
    Session() = default;
    ~Session() { glfwTerminate(); }
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

private:
    std::thread::id thread_ = std::this_thread::get_id();
};

Result<std::unique_ptr<DisplaySink>> GlfwDisplay::open(const ConfigNode& options, const DisplayRequest& request,
                                                       const Surroundings& around) {
    std::string driver, monitor;
    ConfigFields fields(options);
    fields.text("driver", driver);
    fields.optional().text("monitor", monitor);
    TRY(fields.finish());
    std::unique_ptr<GlfwDisplay> sink(new GlfwDisplay(request, around, std::move(monitor)));
    (void)sink->makeCurrent();  // a missing screen is no error yet; the status tells
    return std::unique_ptr<DisplaySink>(std::move(sink));
}

GlfwDisplay::GlfwDisplay(const DisplayRequest& request, const Surroundings& around, std::string monitor)
    : request_(request),
      monitorName_(std::move(monitor)),
      clock_(around.clock),
      retryAfter_(kFirstRetry),
      refreshes_(request.refreshRate),
      status_{request.name, "glfw", DeviceState::Starting, LossAction::Dark, "", 0} {
    if (around.world != nullptr) plug_.emplace(*around.world, request.name, LossAction::Dark);
}

GlfwDisplay::~GlfwDisplay() {
    if (window_ != nullptr) glfwDestroyWindow(window_);
}

DeviceStatus GlfwDisplay::status() const {
    const std::unique_lock lock(statusMutex_);
    DeviceStatus status = status_;
    if (!plug_) return status;
    const DeviceStatus plug = plug_->status();
    status.losses += plug.losses;
    if (plug.state != DeviceState::Running) {
        status.state = plug.state;
        status.detail = plug.detail;
    }
    return status;
}

std::int64_t GlfwDisplay::nextRefresh() const { return refreshes_.running(clock_.now()) + 1; }

Result<void> GlfwDisplay::makeCurrent() {
    FANTASCOPE_CHECK(thread_ == std::this_thread::get_id(), "a window belongs to the thread that opened it");
    if (plug_ && !plug_->in()) {
        hide();
        return plug_->absent();
    }
    const Result<void> appeared = appear();
    {
        const std::lock_guard lock(statusMutex_);
        if (!appeared && status_.state == DeviceState::Running) ++status_.losses;
        status_.state = appeared ? DeviceState::Running : DeviceState::Absent;
        if (appeared)
            status_.detail.clear();
        else
            status_.detail = appeared.error().message();
    }
    if (!appeared) return appeared.error().in(request_.name + " is absent");
    // GLFW knows its own contexts alone; a headless display on this thread makes others current.
    if (eglGetCurrentContext() != glfwGetEGLContext(window_)) glfwMakeContextCurrent(window_);
    return {};
}

Result<void> GlfwDisplay::appear() {
    if (window_ == nullptr) TRY(openWindow());
    glfwPollEvents();
    if (glfwWindowShouldClose(window_)) {
        glfwSetWindowShouldClose(window_, GLFW_FALSE);
        reopenAt_ = clock_.now() + kReopenAfter;
    }
    if (clock_.now() < reopenAt_) {
        hide();
        return Error(fmt::format("its window was closed; it opens again after {} s", seconds(kReopenAfter)));
    }
    const Result<GLFWmonitor*> monitor = wantedMonitor();
    if (!monitor) {
        hide();
        return monitor.error();
    }
    if (!glfwGetWindowAttrib(window_, GLFW_VISIBLE) || glfwGetWindowMonitor(window_) != *monitor) show(*monitor);
    return {};
}

Result<void> GlfwDisplay::openWindow() {
    if (clock_.now() < retryAt_) return Error(status().detail);  // it was refused lately; the reason stands
    retryAt_ = clock_.now() + retryAfter_;
    retryAfter_ = std::min(2 * retryAfter_, kLastRetry);

    if (!session_) session_ = TRY(Session::shared());
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CONTEXT_CREATION_API, GLFW_EGL_CONTEXT_API);  // GLX cannot share a thread with headless displays
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_DEPTH_BITS, 0);  // drawing goes to framebuffer_; the window only gets copies
    glfwWindowHint(GLFW_STENCIL_BITS, 0);
    glfwWindowHint(GLFW_VISIBLE, GLFW_FALSE);
    glfwWindowHint(GLFW_RESIZABLE, GLFW_FALSE);
    glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE);  // a projector stays lit when another window is worked in
    GLFWwindow* window = glfwCreateWindow(request_.size.x, request_.size.y, request_.name.c_str(), nullptr, nullptr);
    if (window == nullptr)
        return Error(fmt::format("no window with OpenGL 4.5 core: {}; update the graphics driver", glfwReason()));
    glfwMakeContextCurrent(window);
    const Result<unsigned> framebuffer = makeSrgbFramebuffer(request_.size);
    if (!framebuffer) {
        glfwDestroyWindow(window);
        return framebuffer.error();
    }
    framebuffer_ = *framebuffer;
    window_ = window;
    return {};
}

Result<GLFWmonitor*> GlfwDisplay::wantedMonitor() const {
    if (monitorName_.empty()) return nullptr;
    for (GLFWmonitor* monitor : monitors()) {
        if (glfwGetMonitorName(monitor) != monitorName_) continue;
        int count = 0;
        const GLFWvidmode* modes = glfwGetVideoModes(monitor, &count);
        const bool fits = std::any_of(
            modes, modes + count, [&](const GLFWvidmode& mode) { return glm::ivec2(mode.width, mode.height) == request_.size; });
        if (!fits)
            return Error(fmt::format("monitor '{}' cannot show {} x {} pixels; give the output a size that it can", monitorName_,
                                     request_.size.x, request_.size.y));
        return monitor;
    }
    std::vector<std::string> names;
    for (GLFWmonitor* monitor : monitors()) names.emplace_back(glfwGetMonitorName(monitor));
    return Error(fmt::format("monitor '{}' is not connected; connected: {}", monitorName_, fmt::join(names, ", ")));
}

void GlfwDisplay::show(GLFWmonitor* monitor) {
    if (monitor != nullptr) {
        glfwSetWindowMonitor(window_, monitor, 0, 0, request_.size.x, request_.size.y,
                             static_cast<int>(request_.refreshRate + 0.5));
        glfwSetInputMode(window_, GLFW_CURSOR, GLFW_CURSOR_HIDDEN);
    }
    glfwShowWindow(window_);
    glfwMakeContextCurrent(window_);
    GLFWmonitor* const screen = monitor != nullptr ? monitor : glfwGetPrimaryMonitor();
    const GLFWvidmode* mode = screen != nullptr ? glfwGetVideoMode(screen) : nullptr;
    swapWaits_ = mode != nullptr && mode->refreshRate > 0 && swapWaits(mode->refreshRate);
    refreshes_ = RefreshTrain(swapWaits_ ? mode->refreshRate : request_.refreshRate);
}

void GlfwDisplay::hide() {
    if (window_ == nullptr || !glfwGetWindowAttrib(window_, GLFW_VISIBLE)) return;
    // GLFW hides no window that fills a monitor.
    if (glfwGetWindowMonitor(window_) != nullptr)
        glfwSetWindowMonitor(window_, nullptr, 0, 0, request_.size.x, request_.size.y, 0);
    glfwHideWindow(window_);
}

bool GlfwDisplay::swapWaits(double hertz) {
    constexpr int kSwaps = 3;
    swap(1);  // the first may find nothing to wait for
    glFinish();
    const Time start = clock_.now();
    for (int i = 0; i < kSwaps; ++i) {
        swap(1);
        glFinish();
    }
    return clock_.now() - start >= tickTime(kSwaps, 2 * hertz);  // at least half a period each
}

void GlfwDisplay::swap(int interval) {
    if (swapInterval_ != interval) glfwSwapInterval(swapInterval_ = interval);
    glfwSwapBuffers(window_);
}

Result<Shown> GlfwDisplay::present(bool paced) {
    TRY(makeCurrent());
    // A copy of stored values: nothing is decoded or encoded on the way.
    glDisable(GL_FRAMEBUFFER_SRGB);
    glBlitNamedFramebuffer(framebuffer_, 0, 0, 0, request_.size.x, request_.size.y, 0, 0, request_.size.x, request_.size.y,
                           GL_COLOR_BUFFER_BIT, GL_NEAREST);
    Shown shown;
    if (swapWaits_ && paced) {
        swap(1);
        glFinish();  // returns when the swap is done, not when it is queued
        shown.refresh = refreshes_.seen(clock_.now());
    } else {
        glFinish();
        shown.refresh = refreshes_.running(clock_.now()) + (paced ? 1 : 0);
        if (paced) clock_.sleepUntil(refreshes_.timeOf(shown.refresh));
        swap(0);
    }
    shown.at = refreshes_.timeOf(shown.refresh);
    return shown;
}

}  // namespace fantascope::drivers
