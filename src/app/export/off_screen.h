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

// An output's pictures as files need them: drawn by the show's own renderer, at any moment of show
// time and in any order, shown to nobody.
// Thread: thread-bound, with the OpenGL context that it makes.
class OffScreen {
public:
    // `blend`: as the output's renderer has it. Error: no OpenGL here, or a size that it does not
    // have.
    static Result<std::unique_ptr<OffScreen>> open(const Projection& projection,
                                                   const std::shared_ptr<const render::BlendMap>& blend,
                                                   const render::PictureSources& sources);
    // The whole canvas from edge to edge of `size` pixels, as it is before any projector.
    static Result<std::unique_ptr<OffScreen>> open(glm::ivec2 size, const render::PictureSources& sources);
    ~OffScreen();

    // Stored values as they would go to a projector. Valid until the next call.
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
