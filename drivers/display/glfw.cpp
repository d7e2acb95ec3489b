#include "drivers/display/glfw.h"

#include "drivers/display/srgb_framebuffer.h"
#include "drivers/display/x_screen.h"

#include <epoxy/gl.h>

#define GLFW_INCLUDE_NONE  // epoxy brings OpenGL
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace fantascope::drivers {
namespace {

constexpr const char* kDriver = "glfw";
constexpr const char* kClosed = "its window was closed; start Fantascope again to show it";
constexpr const char* kEnded = "the X server has ended or closed the connection; the picture is back once the X server is";
constexpr const char* kDestroyed = "another program has destroyed its window; it is made again";
constexpr Time kRetry = std::chrono::seconds(1), kTellsOfLost = std::chrono::seconds(10);
// With vertical sync, a swap that takes longer than this share of a period waited for a refresh; a
// shorter one found room in a queue.
constexpr double kWaitOfSwap = 0.25;

// OpenGL's name of the current context's window.
constexpr GLuint kWindow = 0;

// Whether the current context's window converts linear light to 8-bit sRGB, as our own framebuffers
// do.
bool windowStoresSrgb() {
    const auto of = [](GLenum what) {
        GLint value = 0;
        glGetNamedFramebufferAttachmentParameteriv(kWindow, GL_BACK_LEFT, what, &value);
        return value;
    };
    return of(GL_FRAMEBUFFER_ATTACHMENT_COLOR_ENCODING) == GL_SRGB && of(GL_FRAMEBUFFER_ATTACHMENT_GREEN_SIZE) == 8;
}

// A corner on the X screen, in whole pixels.
Result<glm::ivec2> cornerFrom(const ConfigNode& node) {
    constexpr int kLargest = 32767;  // limit of the X protocol
    const std::vector<ConfigNode> items = TRY(node.items(2, 2));
    const auto x = TRY(items[0].integer(0, kLargest)), y = TRY(items[1].integer(0, kLargest));
    return glm::ivec2(x, y);
}

}  // namespace

Result<std::optional<MonitorClaim>> GlfwDisplay::claimOf(const ConfigNode& options, const DisplayRequest& request) {
    std::string driver;
    std::optional<MonitorChoice> monitor;
    std::optional<glm::ivec2> position;
    ConfigFields fields(options);
    fields.text("driver", driver);
    fields.optional().read("monitor", monitor, MonitorChoice::fromConfig);
    fields.optional().read("position", position, cornerFrom);
    TRY(fields.finish());
    if (position && !monitor) return options.error("'position' needs 'monitor'");
    if (!monitor) return std::optional<MonitorClaim>();
    return std::optional(MonitorClaim{request.name, *monitor, request.size, request.refreshRate, position});
}

Result<Opening<DisplaySink>> GlfwDisplay::fromConfig(const ConfigNode& options, const DisplayRequest& request) {
    const std::optional<MonitorClaim> wanted = TRY(claimOf(options, request));
    Opening<DisplaySink> opening{[=](const DriverContext& driverContext) -> Result<std::unique_ptr<DisplaySink>> {
        std::unique_ptr<GlfwDisplay> sink(new GlfwDisplay(request, driverContext, wanted));
        (void)sink->poll();  // a missing device is no error; its status reports it
        return std::unique_ptr<DisplaySink>(std::move(sink));
    }};
    // Exclusive only by connector or serial number: monitors of one make are given out in the order
    // of the outputs.
    if (wanted && !(wanted->monitor.connector + wanted->monitor.serial).empty())
        opening.uses.push_back({"the monitor " + wanted->monitor.text(), ""});
    // Described as in the site file, so that a show need not wait for the X server.
    if (wanted)
        opening.claim = [monitor = wanted->monitor.text()] {
            return fmt::format("the monitor {} of the X server {}", monitor, XScreen::serverName());
        };
    return opening;
}

GlfwDisplay::GlfwDisplay(const DisplayRequest& request, const DriverContext& driverContext, std::optional<MonitorClaim> wanted)
    : request_(request),
      wanted_(std::move(wanted)),
      clock_(driverContext.clock),
      cable_(request, driverContext),
      refreshes_(request.refreshRate),
      retryAt_(driverContext.clock.now()) {}

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
    if (const auto lost = events_.lastLost(); lost && clock_.now() - *lost < kTellsOfLost)
        status.trouble = "keys or clicks at its window were lost: nobody took them in time. Press them again";
    return status;
}

std::int64_t GlfwDisplay::nextRefresh() const { return refreshes_.running(clock_.now()) + 1; }

Result<void> GlfwDisplay::appear() {
    if (!glfw_) glfw_ = TRY(GlfwLibrary::shared());
    if (window_ == nullptr) TRY(makeWindow());  // even without its monitor, to save time when it comes
    if (!wanted_) return probeVsync();
    if (monitor_) {
        monitor_->tryAgain();
    } else {
        monitor_ = TRY(MonitorWatch::shared())->claim(*wanted_);
        seat_ = monitor_->seat();
    }
    return moveToMonitor();
}

Result<void> GlfwDisplay::makeWindow() {
    // Frames are drawn directly into the window, which saves a copy of each. They need only colours
    // there.
    window_ = TRY(glfw_->makeWindow(request_.name, request_.size,
                                    {{GLFW_RESIZABLE, GLFW_FALSE},
                                     {GLFW_SRGB_CAPABLE, GLFW_TRUE},
                                     {GLFW_DEPTH_BITS, 0},
                                     {GLFW_STENCIL_BITS, 0},
                                     {GLFW_VISIBLE, wanted_ ? GLFW_FALSE : GLFW_TRUE}}));
    if (wanted_)
        takeFromWindowManager(window_);
    else
        glfw_->placeWindow(window_);
    if (!windowStoresSrgb()) {
        const auto framebuffer = makeSrgbFramebuffer(request_.size);
        if (!framebuffer) {
            glfwDestroyWindow(std::exchange(window_, nullptr));
            return framebuffer.error();
        }
        framebuffer_ = *framebuffer;
    }
    context_ = ++contexts_;
    installCallbacks();
    return {};
}

void GlfwDisplay::installCallbacks() {
    glfwSetWindowUserPointer(window_, this);
    static constexpr auto of = [](GLFWwindow* window) { return static_cast<GlfwDisplay*>(glfwGetWindowUserPointer(window)); };
    glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int scanCode, int action, int modifiers) {
        if (const auto known = pressedKey(key, scanCode, modifiers))
            of(window)->events_.give({action == GLFW_RELEASE ? ScreenEvent::Kind::KeyUp : ScreenEvent::Kind::KeyDown, *known,
                                      of(window)->pointer_, of(window)->clock_.now()});
    });
    glfwSetCursorPosCallback(window_, [](GLFWwindow* window, double x, double y) {
        of(window)->pointer_ = {x, y};
        of(window)->events_.give({ScreenEvent::Kind::PointerMoved, {}, {x, y}, of(window)->clock_.now()});
    });
    glfwSetMouseButtonCallback(window_, [](GLFWwindow* window, int button, int action, int) {
        if (button != GLFW_MOUSE_BUTTON_LEFT) return;
        of(window)->events_.give({action == GLFW_PRESS ? ScreenEvent::Kind::ButtonDown : ScreenEvent::Kind::ButtonUp,
                                  {},
                                  of(window)->pointer_,
                                  of(window)->clock_.now()});
    });
}

Result<void> GlfwDisplay::moveToMonitor() {
    if (!seat_.absence.empty()) return Error(seat_.absence);
    if (!glfw_->pollEvents()) return Error(kEnded);
    showAt(window_, seat_.area.corner.x, seat_.area.corner.y);
    if (seat_.hertz > 0 && seat_.hertz != refreshes_.hertz()) refreshes_.runAt(seat_.hertz, clock_.now());
    return probeVsync();
}

Result<void> GlfwDisplay::probeVsync() {
    if (glfw_->vsync) return {};
    constexpr int kSwaps = 4;
    glfwMakeContextCurrent(window_);
    const auto timeOf = [&](int refreshes) -> Result<Time> {
        Time took{};
        for (int number = 0; number <= kSwaps; ++number) {
            const GLfloat black[] = {0, 0, 0, 1};
            glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
            glClearBufferfv(GL_COLOR, 0, black);
            const Time one = TRY(swap(refreshes)).took;
            if (number > 0) took += one;  // the first also waits for earlier work
        }
        return took;
    };
    const Time atOnce = TRY(timeOf(0)), waiting = TRY(timeOf(1));
    glfw_->vsync = seconds(waiting - atOnce) * refreshes_.hertz() > 0.5 * kSwaps;
    return {};
}

void GlfwDisplay::setAbsence(const std::string& why) {
    const std::lock_guard lock(mutex_);
    if (absence_.empty() && !why.empty()) ++losses_;
    absence_ = why;
}

std::optional<std::string> GlfwDisplay::whyLost() const {
    if (glfw_ && glfw_->lost()) return kEnded;
    if (window_ != nullptr && glfw_->destroyed(window_)) return kDestroyed;
    return std::nullopt;
}

void GlfwDisplay::destroyRemains() {
    if (window_ != nullptr) glfwDestroyWindow(std::exchange(window_, nullptr));
    framebuffer_ = 0;
    swapInterval_ = -1;
    if (glfw_->lost()) glfw_.reset();
}

bool GlfwDisplay::poll() {
    if (glfw_) glfw_->pollEvents();
    events_.flush();
    if (const auto lost = whyLost()) {
        if (std::exchange(context_, 0) == 0) destroyRemains();  // only at the second call: until then, mapped memory may be read
        setAbsence(closed_ ? kClosed : *lost);
        retryAt_ = clock_.now() + kRetry;
        return false;
    }
    return updatePlace();
}

bool GlfwDisplay::updatePlace() {
    const Time now = clock_.now();
    const bool moved = monitor_ && seat_ != monitor_->seat();
    if (moved) seat_ = monitor_->seat();
    if (window_ != nullptr && glfwWindowShouldClose(window_)) {
        if (!std::exchange(closed_, true)) glfwHideWindow(window_);
        setAbsence(kClosed);
    } else if (window_ != nullptr && moved) {
        const auto done = moveToMonitor();
        if (!done) glfwHideWindow(window_);
        setAbsence(done ? "" : done.error().message());
        retryAt_ = now + kRetry;
    } else if (!absence_.empty() && !closed_ && now >= retryAt_) {
        retryAt_ = now + kRetry;
        const auto appeared = appear();
        const bool ended = !glfw_ && contexts_ > 0;  // reports the same reason again, not a second event
        setAbsence(appeared ? "" : ended ? kEnded : appeared.error().message());
    }
    return absence_.empty() && cable_.in();
}

Result<void> GlfwDisplay::makeCurrent() {
    if (context_ == 0) return Error(fmt::format("{} has no OpenGL context: {}", request_.name, absence_));
    TRY(cable_.checkGraphics());
    glfwGetError(nullptr);  // clears older errors
    glfwMakeContextCurrent(window_);
    const char* why = nullptr;
    if (glfwGetError(&why) != GLFW_NO_ERROR)
        return Error(fmt::format("{}: its OpenGL context cannot be used: {}; use one render thread", request_.name, why));
    return {};
}

void GlfwDisplay::release() {
    if (window_ != nullptr && glfwGetCurrentContext() == window_) glfwMakeContextCurrent(nullptr);
}

Result<void> GlfwDisplay::ensureRunning() {
    TRY(cable_.check());
    if (const auto lost = whyLost()) return Error(fmt::format("{} is absent: {}", request_.name, *lost));
    if (!updatePlace()) return Error(fmt::format("{} is absent: {}", request_.name, absence_));
    return makeCurrent();
}

Result<void> GlfwDisplay::finish() {
    TRY(makeCurrent());
    if (framebuffer_ != kWindow) {
        // Without conversion, so that stored values arrive unchanged.
        const bool converting = glIsEnabled(GL_FRAMEBUFFER_SRGB);
        glDisable(GL_FRAMEBUFFER_SRGB);
        const auto [width, height] = std::pair(request_.size.x, request_.size.y);
        glBlitNamedFramebuffer(framebuffer_, kWindow, 0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
        if (converting) glEnable(GL_FRAMEBUFFER_SRGB);
    }
    glFinish();  // now only the swap itself can wait
    return {};
}

Result<GlfwDisplay::Swap> GlfwDisplay::swap(int refreshes) {
    const auto check = [&]() -> Result<void> {
        glfw_->pollEvents();
        if (const auto lost = whyLost()) return Error(fmt::format("{} is absent: {}", request_.name, *lost));
        return {};
    };
    TRY(check());
    const Time before = clock_.now();
    if (std::exchange(swapInterval_, refreshes) != refreshes) glfwSwapInterval(refreshes);
    glfwSwapBuffers(window_);
    glFinish();
    const Time after = clock_.now();
    TRY(check());
    return Swap{after, after - before};
}

Result<Shown> GlfwDisplay::present() {
    TRY(ensureRunning());
    std::int64_t refresh = nextRefresh();
    if (!*glfw_->vsync) {
        clock_.sleepUntil(refreshTime(refresh));  // followers use the same clock, so all swap together
        const Swap swapped = TRY(swap(0));
        return Shown{refresh, refreshTime(refresh), swapped.done, swapped.took};
    }
    Swap swapped = TRY(swap(1));
    if (seconds(swapped.took) * refreshes_.hertz() > kWaitOfSwap) {
        refresh = refreshes_.seen(swapped.done);
        swapped.took = std::max(Time{}, swapped.took - tickTime(1, refreshes_.hertz()));
    }
    const Shown shown{refresh, refreshTime(refresh), swapped.done, swapped.took};
    clock_.sleepUntil(shown.at);
    return shown;
}

Result<Shown> GlfwDisplay::presentWith(Time leading) {
    TRY(ensureRunning());
    clock_.sleepUntil(leading);
    const std::int64_t refresh = refreshes_.running(clock_.now());
    const Swap swapped = TRY(swap(0));
    return Shown{refresh, refreshTime(refresh), swapped.done, swapped.took};
}

}  // namespace fantascope::drivers
