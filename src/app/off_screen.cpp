#include "app/off_screen.h"

#include "app/data_folder.h"
#include "drivers/registry.h"

#include "core/check.h"
#include "core/config.h"

namespace fantascope::app {

Result<std::unique_ptr<OffScreen>> OffScreen::open(glm::ivec2 size, const std::array<glm::dvec2, 4>& corners,
                                                   const std::vector<render::PictureSource>& sources) {
    std::unique_ptr<OffScreen> screen(new OffScreen);
    const ConfigNode options = TRY(ConfigNode::parse("driver: headless\n", "off screen"));
    screen->display_ = TRY(drivers::openDisplay(options, {"picture", size, 1.0}, {screen->clock_}));
    TRY(screen->display_->makeCurrent());
    screen->renderer_ = TRY(
        render::OutputRenderer::create({.size = size, .corners = corners, .shaders = dataFolder() / "assets/shaders"}, sources));
    screen->tap_ = std::make_unique<render::FrameTap>(0, size);
    screen->frames_ = &screen->tap_->addReader();
    return screen;
}

OffScreen::~OffScreen() {
    if (!display_ || !display_->makeCurrent()) return;
    tap_.reset();
    renderer_.reset();
}

const RgbaImage& OffScreen::draw(const show::OutputState& state, const Wind& wind, Time showTime) {
    FANTASCOPE_CHECK(display_->makeCurrent().has_value(), "nobody unplugs it");
    renderer_->draw(state, wind, showTime, display_->framebuffer());
    tap_->capture(display_->framebuffer(), showTime);
    tap_->publish({});
    const render::ShownFrame* const frame = frames_->next(Time::max());
    FANTASCOPE_CHECK(frame != nullptr, "what was captured is published");
    return frame->image;
}

}  // namespace fantascope::app
