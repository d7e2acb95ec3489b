#pragma once
// Scenes for the tests of the renderer, and access to the drawn pixels.

#include "drivers/site/world.h"

#include "render/frame_tap.h"
#include "render/output_renderer.h"

#include "device/display_sink.h"

#include "core/clock.h"
#include "media/image.h"
#include "media/projection.h"

#include <glm/vec2.hpp>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace fantascope::render {

// A small pattern with all kinds of content: flat triangles and squares, closed crystals, an open
// roof that shows both sides; in overlapping clusters, partly over the canvas's edge, in several
// colours and groups. 16:9.
pattern::ShapePattern smallPattern();

PatternSource resting(pattern::ShapePattern pattern);
PatternSource moving(pattern::ShapePattern pattern);

// An upright square with a half-diagonal of `size`; its edges are size * sqrt(2) long.
pattern::ShapePattern squareAt(glm::dvec2 centre, double size, glm::vec3 colour, double aspect = 16.0 / 9);

// Corners inside a picture of `size` with a strong keystone.
std::array<glm::dvec2, 4> keystone(glm::ivec2 size);

// A projection of `size` pixels with these corners, without dither and colour settings.
Projection projectionTo(glm::ivec2 size, const std::array<glm::dvec2, 4>& corners);

// One output of the named driver, its renderer and a tap of it.
class DrawnOutput {
public:
    DrawnOutput(const Projection& projection, const std::vector<PictureSource>& sources,
                std::shared_ptr<const BlendMap> blend = nullptr, const std::string& driver = "headless",
                std::shared_ptr<const GreyImage> gain = nullptr);
    DrawnOutput(glm::ivec2 size, const std::array<glm::dvec2, 4>& corners, const std::vector<PictureSource>& sources,
                const std::string& driver = "headless")
        : DrawnOutput(projectionTo(size, corners), sources, nullptr, driver) {}
    ~DrawnOutput();

    // Draws and presents one frame, and returns the shown picture.
    const RgbaImage& frame(const show::OutputState& state, Time time = Time::zero(), const Wind& wind = {});
    // The same for layers given by source and opacity.
    const RgbaImage& frame(const std::vector<show::LayerState>& layers, Time time = Time::zero()) {
        return frame(show::OutputState{layers}, time);
    }
    FrameTap& tap() { return *tap_; }
    OutputRenderer& renderer() { return *renderer_; }
    DisplaySink& sink() { return *sink_; }

private:
    ManualClock clock_;
    std::unique_ptr<DisplaySink> sink_;
    std::unique_ptr<OutputRenderer> renderer_;
    std::unique_ptr<FrameTap> tap_;
    FrameReader* newest_ = nullptr;
};

// The difference of two pictures of the same size over all colour channels, in stored values 0 ..
// 255.
struct Difference {
    double rms = 0;
    int most = 0;
};
Difference difference(const RgbaImage& a, const RgbaImage& b);

std::filesystem::path shaderFolder();

}  // namespace fantascope::render
