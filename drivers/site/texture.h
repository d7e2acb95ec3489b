#pragma once

#include "media/image.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <optional>
#include <vector>

namespace fantascope::site {

// A parallelogram in the world, from a corner along two edges; metres. The edges are not parallel.
struct Rectangle {
    glm::dvec3 corner{0.0}, right{1, 0, 0}, up{0, 1, 0};

    glm::dvec3 normal() const;  // unit, along right x up
    // How many edges to the right and up a point lies; its distance from the plane does not matter.
    glm::dvec2 placeOf(glm::dvec3 point) const;
};

// A picture on a rectangle, with a share of reflected light for each place. It is averaged over
// finer and coarser cells, so that a distant picture does not alias. Immutable; thread-safe.
class Texture {
public:
    // `picture`: stored sRGB, not empty; its top lies at the rectangle's upper edge. `tile`: the
    // picture's width and height on the rectangle, metres, > 0; it repeats from the corner on.
    // Without it the picture covers the rectangle once.
    Texture(const RgbaImage& picture, const Rectangle& rectangle, std::optional<glm::dvec2> tile);

    // Linear RGB around a point, over a spot that reaches from -long/2 to long/2 and is `width`
    // metres wide. Bilinear between cells.
    glm::vec3 around(glm::dvec3 point, glm::dvec3 longSide, double width) const;

private:
    using Cells = Image<glm::vec3>;
    static Cells halved(const Cells& fine);
    glm::vec3 at(const Cells& cells, glm::dvec2 place) const;

    Rectangle rectangle_;
    glm::dvec2 tiles_{1.0};      // along the edges
    bool repeats_ = false;       // else the edge pixels go on beyond the picture
    double cellsPerMetre_ = 0;   // of the finest level, along the direction that has more
    std::vector<Cells> levels_;  // each half as wide and high as the one before, down to a single cell
};

}  // namespace fantascope::site
