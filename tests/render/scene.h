#pragma once
// What the tests of the renderer draw, and how they get at the pixels.

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

// A small pattern with everything in it: flat triangles and squares, closed crystals, an open roof
// that shows both sides, in overlapping clumps, some of them over the canvas's edge, in several
// colours and groups. 16:9.
pattern::ShapePattern smallPattern();

PatternSource resting(pattern::ShapePattern pattern);
PatternSource moving(pattern::ShapePattern pattern);

// A square of half-diagonal `size` that stands straight; its edges are size * sqrt(2) long.
pattern::ShapePattern squareAt(glm::dvec2 centre, double size, glm::vec3 colour, double aspect = 16.0 / 9);

// Corners in a picture of `size`, with a clear keystone, all inside.
std::array<glm::dvec2, 4> keystone(glm::ivec2 size);

// Corners in a picture of `size` for a projector that neither dithers nor colours.
Projection projectionTo(glm::ivec2 size, const std::array<glm::dvec2, 4>& corners);

// One output of the named driver, its renderer and a tap of it.
class DrawnOutput {
public:
    DrawnOutput(const Projection& projection, const std::vector<PictureSource>& sources,
                std::shared_ptr<const BlendMap> blend = nullptr, const std::string& driver = "headless");
    DrawnOutput(glm::ivec2 size, const std::array<glm::dvec2, 4>& corners, const std::vector<PictureSource>& sources,
                const std::string& driver = "headless")
        : DrawnOutput(projectionTo(size, corners), sources, nullptr, driver) {}
    ~DrawnOutput();

    // Draws and presents one frame, and returns it as it was shown.
    const RgbaImage& frame(const show::OutputState& state, Time time = Time::zero(), const Wind& wind = {});
    // All layers by source and opacity.
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

// How far two pictures of one size are apart, in stored values of 0 .. 255, over all colour
// channels.
struct Difference {
    double rms = 0;
    int most = 0;
};
Difference difference(const RgbaImage& a, const RgbaImage& b);

std::filesystem::path shaderFolder();

}  // namespace fantascope::render
