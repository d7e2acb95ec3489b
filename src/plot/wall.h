#pragma once

#include "media/image.h"
#include "media/projection.h"
#include "plot/sheet.h"

#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>

namespace fantascope::plot {

// How a projector's pixels lie on the wall: possibly mirrored and rotated by quarter turns. Texts
// that are drawn upright in wall pixels are upright on the wall. There are eight ways, and each
// maps whole pixels to whole pixels.
class Wall {
public:
    explicit Wall(const Projection& projection);

    glm::ivec2 size() const;                             // wall pixels
    glm::ivec2 projector() const { return projector_; }  // projector pixels
    glm::dvec2 fromProjector(glm::dvec2 pixel) const;
    // The picture for the projector of a sheet that was drawn in wall pixels.
    RgbaImage toProjector(Sheet& sheet) const;

private:
    glm::ivec2 projector_;
    glm::dmat2 projectorFromWall_{1.0};  // about the pictures' middles; entries 0, 1 and -1
};

}  // namespace fantascope::plot
