#pragma once

#include "drivers/common/opening.h"
#include "drivers/display/cable.h"
#include "drivers/display/refresh_train.h"

#include "device/display_sink.h"

#include "core/config/config.h"

#include <memory>

namespace fantascope::drivers {

// A display without a window system: real OpenGL through EGL only, with Mesa's software renderer or
// a GPU. Its refreshes are those of a clock: number k takes place at tickTime(k, rate). A simulated
// site can unplug it.
//
// One finished frame is held until its refresh, as in a graphics card's swap chain.
// The context lives as long as the object.
class HeadlessDisplay final : public DisplaySink {
public:
    // Keys: none of its own. Error: a wrong key; when opened: no OpenGL 4.5 (it names the Debian
    // packages that provide it).
    static Result<Opening<DisplaySink>> fromConfig(const ConfigNode& options, const DisplayRequest& request);
    ~HeadlessDisplay() override;

    DeviceStatus status() const override;
    glm::ivec2 size() const override { return request_.size; }
    double refreshRate() const override { return request_.refreshRate; }
    std::int64_t nextRefresh() const override;
    Time refreshTime(std::int64_t number) const override;
    bool poll() override { return cable_.in(); }
    int context() const override { return 1; }
    Result<void> makeCurrent() override;
    void release() override;
    unsigned framebuffer() const override { return framebuffer_; }
    Result<void> finish() override;
    Result<Shown> present() override;
    Result<Shown> presentWith(Time leading) override;

private:
    static Result<std::unique_ptr<DisplaySink>> open(const ConfigNode& options, const DisplayRequest& request,
                                                     const DriverContext& driverContext);
    Shown heldUntil(std::int64_t refresh);
    HeadlessDisplay(const DisplayRequest& request, const DriverContext& driverContext, void* egl, void* context);

    DisplayRequest request_;
    Clock& clock_;
    RefreshTrain refreshes_;
    Cable cable_;
    void* egl_;      // EGLDisplay
    void* context_;  // EGLContext
    unsigned framebuffer_ = 0;
    std::int64_t shown_ = -1;  // the refresh of the newest frame, current or future
};

}  // namespace fantascope::drivers
