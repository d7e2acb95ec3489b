#include "drivers/display/headless.h"

#include "drivers/display/srgb_framebuffer.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <utility>
#include <vector>

namespace fantascope::drivers {
namespace {

constexpr const char* kDriver = "headless";
constexpr const char* kPackages =
    "Debian's packages libegl1, libegl-mesa0 and libgl1-mesa-dri bring a software OpenGL: apt-get install libegl1 libegl-mesa0 "
    "libgl1-mesa-dri";

// An OpenGL 4.5 core context that draws only into framebuffer objects. Error: why `display` has
// none.
Result<EGLContext> makeContext(EGLDisplay display) {
    for (const char* needed : {"EGL_KHR_create_context", "EGL_KHR_no_config_context", "EGL_KHR_surfaceless_context"})
        if (!epoxy_has_egl_extension(display, needed)) return Error(fmt::format("{} is missing", needed));
    if (!eglBindAPI(EGL_OPENGL_API)) return Error("it has no desktop OpenGL");
    const EGLint attributes[] = {
        EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (context == EGL_NO_CONTEXT) return Error("it has no OpenGL 4.5 core");
    return context;
}

// The process's one connection to EGL, made when a headless display first needs it. It is kept to
// the end, because opening it loads a whole driver and Mesa never frees all of it. Tries Mesa
// without a window system, then every GPU that EGL lists. Error: why each failed.
Result<EGLDisplay> connection() {
    static std::mutex mutex;
    static EGLDisplay open = EGL_NO_DISPLAY;
    const std::lock_guard lock(mutex);
    if (open != EGL_NO_DISPLAY) return open;

    if (!epoxy_has_egl()) return Error(fmt::format("EGL is missing; {}", kPackages));
    std::vector<std::pair<std::string, EGLDisplay>> candidates;
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
        candidates.emplace_back("Mesa without a window system",
                                eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device")) {
        EGLint count = 0;
        eglQueryDevicesEXT(0, nullptr, &count);
        std::vector<EGLDeviceEXT> devices(static_cast<std::size_t>(count));
        eglQueryDevicesEXT(count, devices.data(), &count);
        for (std::size_t i = 0; i < devices.size(); ++i)
            candidates.emplace_back(fmt::format("EGL device {}", i),
                                    eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
    }

    std::string reasons;
    for (const auto& [name, display] : candidates) {
        if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) {
            reasons += fmt::format("{}: it cannot be initialised; ", name);
            continue;
        }
        const auto context = makeContext(display);
        if (context) {
            eglDestroyContext(display, *context);
            open = display;
            return open;
        }
        reasons += fmt::format("{}: {}; ", name, context.error().message());
        eglTerminate(display);
    }
    return Error(fmt::format("no OpenGL 4.5 without a window system: {}{}", reasons, kPackages));
}

}  // namespace

Result<Opening<DisplaySink>> HeadlessDisplay::fromConfig(const ConfigNode& options, const DisplayRequest& request) {
    std::string driver;
    ConfigFields fields(options);
    fields.text("driver", driver);
    TRY(fields.finish());
    return Opening<DisplaySink>{[=](const DriverContext& driverContext) { return open(options, request, driverContext); }};
}

Result<std::unique_ptr<DisplaySink>> HeadlessDisplay::open(const ConfigNode& options, const DisplayRequest& request,
                                                           const DriverContext& driverContext) {
    const EGLDisplay egl = TRY(connection().in(options.error("display").message()));
    const EGLContext context = TRY(makeContext(egl));
    std::unique_ptr<HeadlessDisplay> sink(new HeadlessDisplay(request, driverContext, egl, context));
    eglMakeCurrent(egl, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
    sink->framebuffer_ = TRY(makeSrgbFramebuffer(request.size).in(options.error(request.name).message()));
    return std::unique_ptr<DisplaySink>(std::move(sink));
}

HeadlessDisplay::HeadlessDisplay(const DisplayRequest& request, const DriverContext& driverContext, void* egl, void* context)
    : request_(request),
      clock_(driverContext.clock),
      refreshes_(request.refreshRate),
      cable_(request, driverContext),
      egl_(egl),
      context_(context) {}

HeadlessDisplay::~HeadlessDisplay() {
    release();
    eglDestroyContext(egl_, context_);
}

DeviceStatus HeadlessDisplay::status() const { return cable_.status(kDriver); }

std::int64_t HeadlessDisplay::nextRefresh() const { return std::max(refreshes_.running(clock_.now()), shown_) + 1; }

Time HeadlessDisplay::refreshTime(std::int64_t number) const { return refreshes_.timeOf(number); }

Result<void> HeadlessDisplay::makeCurrent() {
    TRY(cable_.checkGraphics());
    // Making the current context current again would make EGL flush.
    if (eglGetCurrentContext() == context_) return {};
    eglBindAPI(EGL_OPENGL_API);  // each thread has its own, at first another
    if (!eglMakeCurrent(egl_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_))
        return Error(fmt::format("{}: its OpenGL context is current on another thread; use one render thread", request_.name));
    return {};
}

void HeadlessDisplay::release() {
    if (eglGetCurrentContext() == context_) eglMakeCurrent(egl_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

Result<void> HeadlessDisplay::finish() {
    TRY(makeCurrent());
    glFinish();
    return {};
}

Shown HeadlessDisplay::heldUntil(std::int64_t refresh) {
    shown_ = refresh;
    return {.refresh = refresh, .at = refreshTime(refresh), .swapped = refreshTime(refresh)};
}

Result<Shown> HeadlessDisplay::present() {
    TRY(cable_.check());
    TRY(makeCurrent());
    const Shown shown = heldUntil(nextRefresh());
    // Another frame may be drawn once the previous one is replaced.
    clock_.sleepUntil(refreshTime(shown.refresh - 1));
    return shown;
}

Result<Shown> HeadlessDisplay::presentWith(Time leading) {
    TRY(cable_.check());
    TRY(makeCurrent());
    const Time now = clock_.now();
    const std::int64_t running = refreshes_.running(now);
    if (leading <= now) return heldUntil(running);
    const Time halfPeriod = tickTime(1, 2 * request_.refreshRate);
    return heldUntil(std::max(refreshes_.running(leading + halfPeriod), running + 1));
}

}  // namespace fantascope::drivers
