#include "app/lens/lens_camera.h"

#include "drivers/registry.h"

#include <fmt/format.h>

#include <utility>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;

class RealCamera final : public LensCamera {
public:
    RealCamera(SiteClaims claims, std::unique_ptr<CameraSource> camera, Clock& clock)
        : claims_(std::move(claims)), camera_(std::move(camera)), clock_(clock) {}

    std::shared_ptr<const CameraFrame> next() override {
        constexpr Time kLook = 5ms;
        if (auto frame = camera_->newest()) return frame;
        clock_.sleepUntil(clock_.now() + kLook);
        return camera_->newest();
    }
    DeviceStatus status() const override { return camera_->status(); }
    CameraDescription description() const override { return camera_->description(); }

private:
    SiteClaims claims_;
    std::unique_ptr<CameraSource> camera_;
    Clock& clock_;
};

}  // namespace

Result<std::unique_ptr<LensCamera>> openCamera(const show::Site& site, const ConfigNode& options, Clock& clock,
                                               const Interrupt& interrupt) {
    show::Site alone;
    alone.file = site.file;
    alone.camera = show::DeviceConfig{site.camera->driver, options};
    SiteClaims claims = TRY(SiteClaims::take(alone, interrupt));
    auto camera = TRY(drivers::openCamera(options, {clock}));
    return std::unique_ptr<LensCamera>(new RealCamera(std::move(claims), std::move(camera), clock));
}

Result<std::unique_ptr<LensCamera>> openCamera(const show::Site& site, Clock& clock, const Interrupt& interrupt) {
    return openCamera(site, site.camera->options, clock, interrupt);
}

}  // namespace fantascope::app
