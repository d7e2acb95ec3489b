#pragma once

#include "app/site/canvas_view.h"

#include "media/image.h"

#include <glm/vec2.hpp>

#include <cstdint>

namespace fantascope::app {

// What the light from a canvas point hits.
enum class Meets : std::uint8_t {
    Surface,  // the output's surface; anything, if the site declares none
    Object,   // something else, in front of the surface or beyond its edge
    Nothing,  // nothing
    NoLight   // no light: the warp maps the point outside the projector's picture
};

// The picture to draw a guide over (Ji et al. 2015, section 5 and Figure 7b-c): the scene from the
// projector's point of view, in canvas space. What is drawn over an object will light it.
struct GuideTemplate {
    // The shaded scene with outlines, a grid in the site's metres, orientation marks, and hatching
    // where a point does not hit Surface.
    RgbaImage picture;
    Image<Meets> meets;          // at each pixel's centre
    Image<std::int32_t> object;  // index of the scene's object there, -1: none
};
// `size`: of the whole canvas, pixels. `grid`: distance between lines of equal x, y and z, metres,
// > 0. The result does not depend on `threads`.
GuideTemplate drawGuideTemplate(const CanvasView& view, glm::ivec2 size, double grid, int threads);

}  // namespace fantascope::app
