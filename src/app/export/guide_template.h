#pragma once

#include "app/site/canvas_view.h"

#include "media/image.h"

#include <glm/vec2.hpp>

#include <cstdint>

namespace fantascope::app {

// What the light meets that a canvas point sends out.
enum class Meets : std::uint8_t {
    Surface,  // what the output is meant for; where the site declares none, anything
    Object,   // something else: the surface is in its shadow, or ends before it
    Nothing,  // it goes past everything
    NoLight   // the warp puts the point outside of the projector's picture
};

// The picture to draw a guide over (Ji et al. 2015, section 5 and Figure 7b-c): the scene from the
// projector's point of view, in canvas space, so that what is drawn over something lights it.
struct GuideTemplate {
    // Shaded scene, outlines, a grid in the site's metres, orientation marks, and hatching where a
    // point does not meet Surface.
    RgbaImage picture;
    Image<Meets> meets;          // of each pixel's centre
    Image<std::int32_t> object;  // the scene's object there, -1 for none
};
// `size` in pixels is the whole canvas; `grid` in metres between lines of equal x, y and z, > 0.
// The result does not depend on `threads`.
GuideTemplate drawGuideTemplate(const CanvasView& view, glm::ivec2 size, double grid, int threads);

}  // namespace fantascope::app
