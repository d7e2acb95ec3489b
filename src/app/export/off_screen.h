#pragma once

#include "render/frame_tap.h"
#include "render/output_renderer.h"

#include "device/display_sink.h"

#include "core/clock.h"
#include "core/result.h"
#include "media/image.h"
#include "media/projection.h"

#include <glm/vec2.hpp>

#include <memory>
#include <vector>

namespace fantascope::app {

// Draws an output's pictures for files: by the show's own renderer, at any show time and in any
// order, without a window.
// Thread: thread-bound, with an OpenGL context of its own.
class OffScreen {
public:
    // `blend`: as for OutputRenderer. Error: there is no OpenGL here, or the size is too large for
    // it.
    static Result<std::unique_ptr<OffScreen>> open(const Projection& projection,
                                                   const std::shared_ptr<const render::BlendMap>& blend,
                                                   const std::vector<render::PictureSource>& sources);
    // Fills `size` pixels with the whole canvas, without a projector's warp and colours.
    static Result<std::unique_ptr<OffScreen>> open(glm::ivec2 size, const std::vector<render::PictureSource>& sources);
    ~OffScreen();

    // Returns stored values, as they would be sent to a projector. Valid until the next call.
    const RgbaImage& draw(const show::OutputState& state, const Wind& wind, Time showTime);

private:
    OffScreen() = default;

    ManualClock clock_;
    std::unique_ptr<DisplaySink> display_;
    std::unique_ptr<render::OutputRenderer> renderer_;
    std::unique_ptr<render::FrameTap> tap_;
    render::FrameReader* frames_ = nullptr;
};

}  // namespace fantascope::app
