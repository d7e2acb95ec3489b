#pragma once

#include "theatre/stage/prop.h"
#include "theatre/stage/screen.h"

#include "core/geometry.h"
#include "core/result.h"
#include "media/image.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

namespace fantascope::theatre {

// Where the theatre plays. Its frame: metres, +y up, the floor at y = 0; +x is to the right as seen
// from the light, and so in the picture. The first beam's screen stands upright at z = 0, with its
// light before it at +z. Each beam is a light and the screen that its shadows fall on: the first
// screen, or one that stands elsewhere.
struct Stage {
    // A box that people may stand on. `turn` is about its upright axis, radians, right-handed.
    struct Platform {
        std::string name;
        glm::dvec3 centre{0}, size{1};
        double turn = 0;

        // The point of the box at coordinates from -0.5 to 0.5 along its axes.
        glm::dvec3 point(const glm::dvec3& share) const;
        double top() const { return centre.y + 0.5 * size.y; }
        bool isUnder(double x, double z) const;  // seen from above
        // The signed distance to the platform, negative inside; `outward` becomes the unit
        // direction in which it grows. A platform that stands on the floor continues below it.
        double distance(const glm::dvec3& point, glm::dvec3& outward) const;
    };
    // An area of the floor, or of the screen; a side without a limit is infinite.
    struct Area {
        static constexpr double kFar = std::numeric_limits<double>::infinity();
        glm::dvec2 from{-kFar}, to{kFar};
        // The distance of a point from the area, 0 inside.
        double outside(glm::dvec2 point) const;
    };

    struct Beam {
        glm::dvec3 light{0, 0, 7};
        std::size_t screen = 0;     // index in Stage::screens; 0 for the first beam
        std::optional<Area> lit{};  // (x, y) of its flat screen, lit by a projector at `light`; none: a lamp lights everything
    };

    std::vector<Beam> beams{Beam{}};  // one or more
    std::optional<Area> standing{};   // (x, z) of the floor where people may stand; none: anywhere
    std::vector<Platform> platforms{};
    std::vector<Prop> props{};
    std::vector<Screen> screens{Screen{}};  // the first beam's comes first; its frame is the stage's

    const Screen& screenOf(std::size_t beam) const { return screens[beams[beam].screen]; }
    // The transform into the frame of a beam's screen, and the beam's light in that frame. For the
    // first beam it is the identity.
    glm::dmat4 screenFromStage(std::size_t beam) const;
    glm::dvec3 lightOnScreen(std::size_t beam) const { return screenOf(beam).screenFromStage(beams[beam].light); }

    // The height of the ground under a point: the highest platform whose top is not above the
    // point, or else the floor.
    double groundUnder(const glm::dvec3& point) const;
    // Error: a prop's holder is not among the `actors` actors.
    Result<void> checkHolders(std::size_t actors) const;
};

// A pixel grid on the flat screen of a beam. Target, shadow and masks share it. Pixel (column,
// row), row 0 at the top, is centred at half-integers.
class ScreenFrame {
public:
    // `left`, `top`: the edges of the grid, metres in the screen's frame. `pixel`: the side of a
    // pixel, metres.
    ScreenFrame(const Stage& stage, double left, double top, double pixel, int width, int height, std::size_t beam = 0);

    int width() const { return width_; }
    int height() const { return height_; }
    double pixel() const { return pixel_; }
    glm::dvec2 pixelAt(double x, double y) const { return {(x - left_) / pixel_, (top_ - y) / pixel_}; }
    glm::dvec2 metresAt(glm::dvec2 pixel) const { return {left_ + pixel.x * pixel_, top_ - pixel.y * pixel_}; }
    // The pixel where the shadow of a point of the stage falls. The point must be nearer to the
    // screen than the light is.
    glm::dvec2 shadow(const glm::dvec3& point) const {
        const glm::dvec3 d = fromLight(point);
        return foot_ + focus_ / d.z * glm::dvec2(d);
    }

    // The frame as a pinhole camera at the light that looks at the screen. A pixel is at foot +
    // focus (x, y) / z.
    glm::dvec2 foot() const { return foot_; }              // the pixel straight in front of the light
    double focus() const { return focus_; }                // the light's distance from the screen, pixels
    glm::dvec3 fromLight(const glm::dvec3& point) const {  // x right, y down, z towards the screen
        const glm::dvec3 way(point.x - light_.x, light_.y - point.y, light_.z - point.z);
        return {cosine_ * way.x + sine_ * way.z, way.y, cosine_ * way.z - sine_ * way.x};
    }
    // Turns a direction of that camera into the stage's frame.
    glm::dvec3 onStage(const glm::dvec3& way) const {
        return {cosine_ * way.x - sine_ * way.z, -way.y, -sine_ * way.x - cosine_ * way.z};
    }
    const glm::dvec3& light() const { return light_; }  // on the stage

private:
    glm::dvec3 light_;
    double cosine_, sine_;  // of the screen's turn
    double left_, top_, pixel_;
    int width_, height_;
    glm::dvec2 foot_;
    double focus_;
};

}  // namespace fantascope::theatre
