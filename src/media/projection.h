#pragma once

#include "core/warp.h"
#include "media/colour_cube.h"
#include "media/image.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fantascope {

// What an output must not light: a part of its picture.
struct Mask {
    static constexpr std::size_t kMost = 32, kMostPoints = 1024;  // of an output, of a polygon
    static constexpr double kFarthest = 32768;                    // pixels: a point may lie outside of the picture
    static constexpr double kWidestFeather = 16384;

    std::vector<glm::dvec2> polygon{};         // projector pixels; empty: the picture counts
    bool hidesOutside = false;                 // of the polygon; else its inside
    std::shared_ptr<const GreyImage> image{};  // stretched over the projector's picture: 1 lets light through, 0 none
    std::string imageFile{};                   // that it was read from, as the site file names it
    double feather = 0;                        // pixels over which the polygon's edge fades, half of it on either side
    friend bool operator==(const Mask&, const Mask&) = default;
};

// What a projector makes of stored values, and how its light is to look.
struct ProjectorLight {
    // Light = stored ^ gamma; none: the sRGB function, as of a monitor.
    std::optional<double> gamma;
    double blackLevel = 0;                     // the light of a black pixel, as a share of a white one
    glm::dvec3 white{1.0};                     // of each primary, 0..1 in linear light: what makes its white that of the others
    double brightness = 1;                     // 0..1, linear
    std::shared_ptr<const ColourCube> cube{};  // of stored sRGB values, before blends and masks; null: none
    bool dither = true;                        // hides the steps between stored values
    friend bool operator==(const ProjectorLight&, const ProjectorLight&) = default;
};

// How one projector throws its part of a canvas.
struct Projection {
    glm::ivec2 size{0};  // pixels of the projector
    Warp warp = Warp::straight({1, 1});
    std::vector<Mask> masks{};
    ProjectorLight light{};
    double canvasAspect = 0;  // width / height of the whole canvas on the wall; 0: unknown, every picture fills it
};

// What a technician puts on the outputs instead of the show.
enum class TestPicture {
    None,
    Grid,     // lines of the canvas and circles: geometry, and whether neighbours meet
    Corners,  // where the picture's corners and the projector's outermost pixels lie
    Numbers,  // which output this is, which way up, and what part of the canvas it shows
    Bars,     // colours
    Ramp,     // greys
    Focus,    // pairs of lines a pixel wide all over the projector's own pixels
    Identify  // number, name and size
};

}  // namespace fantascope
