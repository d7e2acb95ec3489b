#include "app/export/off_screen.h"

#include "app/base/data_folder.h"
#include "drivers/registry.h"

#include "core/check.h"
#include "core/config/config.h"

#include <limits>

namespace fantascope::app {

Result<std::unique_ptr<OffScreen>> OffScreen::open(glm::ivec2 size, const render::PictureSources& sources) {
    Projection straight{size, Warp::straight(size)};
    straight.light.dither = false;
    straight.canvasAspect = static_cast<double>(size.x) / size.y;
    return open(straight, nullptr, sources);
}

Result<std::unique_ptr<OffScreen>> OffScreen::open(const Projection& projection,
                                                   const std::shared_ptr<const render::BlendMap>& blend,
                                                   const render::PictureSources& sources) {
    const glm::ivec2 size = projection.size;
    std::unique_ptr<OffScreen> screen(new OffScreen);
    const ConfigNode options = TRY(ConfigNode::parse("driver: headless\n", "off screen"));
    screen->display_ = TRY(drivers::openDisplay(options, {"picture", size, 1.0}, {screen->clock_}));
    TRY(screen->display_->makeCurrent());
    const std::filesystem::path shaders = TRY(dataFolder()) / "assets/shaders";
    screen->renderer_ =
        TRY(render::OutputRenderer::create({.projection = projection, .blend = blend, .shaders = shaders}, sources));
    screen->tap_ = std::make_unique<render::FrameTap>(0, size);
    screen->frames_ = &screen->tap_->addNewest(std::numeric_limits<double>::infinity());
    return screen;
}

OffScreen::~OffScreen() {
    if (!display_ || !display_->makeCurrent()) return;
    tap_.reset();
    renderer_.reset();
}

const RgbaImage& OffScreen::draw(const show::OutputState& state, const Wind& wind, Time showTime) {
    FANTASCOPE_CHECK(display_->makeCurrent().has_value(), "a headless display is never lost");
    renderer_->draw(state, wind, showTime, display_->framebuffer());
    tap_->capture(display_->framebuffer(), showTime);
    tap_->publish({});
    tap_->finish();
    const render::ShownFrame* const frame = frames_->next(Time::max());
    FANTASCOPE_CHECK(frame != nullptr, "what was captured is published");
    return frame->image;
}

}  // namespace fantascope::app
