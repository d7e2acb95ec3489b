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

// A part of an output's picture that must stay dark.
struct Mask {
    static constexpr std::size_t kMax = 32, kMaxPoints = 1024;  // per output, per polygon
    static constexpr double kMaxCoordinate = 32768;             // pixels; a point may lie outside the picture
    static constexpr double kMaxFeather = 16384;

    std::vector<glm::dvec2> polygon{};         // projector pixels; empty: `image` counts
    bool hidesOutside = false;                 // of the polygon; else its inside
    std::shared_ptr<const GreyImage> image{};  // stretched over the projector's picture: 1 lets light through, 0 blocks it
    std::string imageFile{};                   // the file of `image`, as the site file names it
    double feather = 0;                        // pixels over which the polygon's edge fades, half of it on either side
    friend bool operator==(const Mask&, const Mask&) = default;
};

// How a projector turns stored values into light, and how its light should look.
struct ProjectorLight {
    // Light = stored ^ gamma; nothing: the sRGB function, like a monitor.
    std::optional<double> gamma;
    double blackLevel = 0;  // the light of a black pixel, as a share of a white one
    glm::dvec3 white{1.0};  // factor of each primary, 0..1 in linear light, to match the white of the other projectors
    double brightness = 1;  // 0..1, linear
    std::shared_ptr<const ColourCube> cube{};  // applied to stored sRGB values, before blends and masks; null: none
    bool dither = true;                        // hides the steps between stored values
    friend bool operator==(const ProjectorLight&, const ProjectorLight&) = default;
};

// How a projector shows its part of a canvas.
struct Projection {
    glm::ivec2 size{0};  // pixels of the projector
    Warp warp = Warp::straight({1, 1});
    std::vector<Mask> masks{};
    ProjectorLight light{};
    double canvasAspect = 0;  // width / height of the whole canvas on the wall; 0: unknown, every picture fills it
};

// A test picture on the outputs in place of the show.
enum class TestPicture {
    None,
    Grid,     // lines of the canvas and circles: geometry, and whether neighbours meet
    Corners,  // the picture's corners and the projector's outermost pixels
    Numbers,  // the output's number, its orientation, and its part of the canvas
    Bars,     // colours
    Ramp,     // greys
    Focus,    // pairs of lines one pixel wide, all over the projector's own pixels
    Identify  // number, name and size
};

}  // namespace fantascope
