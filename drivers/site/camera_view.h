#pragma once

#include "drivers/site/projected_light.h"
#include "drivers/site/scene.h"

#include "vision/camera_model.h"

#include "media/image.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace fantascope::site {

// The light of each colour channel has the photometric unit that white light of the same strength
// has: lux on a surface, candela per square metre from it, both linear.

// A lamp: a small round head whose light falls off from its aim. The intensity at an angle from the
// aim is candela * exp(-(angle / a)^p). a and p make it a half at half the beam angle and a tenth
// at half the field angle, as these angles are defined (ANSI E1.9).
struct Lamp {
    glm::dvec3 position{0.0};        // metres
    glm::dvec3 aim{0, -1, 0};        // unit
    double beam = 0.4, field = 0.6;  // full angles, radians; field > beam
    glm::dvec3 colour{1.0};          // linear RGB, 0..1
    double candela = 1000;           // along the aim
    double radius = 0.1;             // of the luminous head, metres

    double intensity(glm::dvec3 direction) const;  // candela towards a unit direction
};

// What shines at one moment.
struct Lighting {
    std::span<const glm::vec3> levels;       // of the lamps: linear, 1 is full power
    std::span<const ProjectedLight> frames;  // of the projectors
    double fog = 0;                          // extinction per metre
};

// Rows of a picture, from `first` to before `end`.
struct Rows {
    int first = 0, end = 0;
};

// The camera's view of a scene as a sum over its lights. How much of each light reaches each pixel
// is computed in advance (direct light on matt surfaces, with shadows); a picture is then one pass
// over these weights. Thread-bound.
class CameraView {
public:
    // `scene` outlives the view. `ambient`: lux on every surface; `sky`: cd/m2 where there is no
    // surface.
    CameraView(const Scene& scene, const vision::CameraModel& camera, glm::dvec3 ambient, glm::dvec3 sky);

    // Lamps and projectors are numbered from 0 in the order in which they are added.
    void addLamp(const Lamp& lamp);
    // `lumens`: of a full white picture, spread evenly over a wall that the lens faces squarely.
    void addProjector(const vision::CameraModel& projector, double lumens);
    // Recomputes one projector's light, in some tens of milliseconds.
    void moveProjector(std::size_t projector, const vision::CameraModel& model);

    // Fills the rows of `luminance` (cd/m2, the camera's size). Fog weakens light along its whole
    // way, and the lit fog veils distant surfaces.
    void render(const Lighting& lighting, Rows rows, Image<glm::vec3>& luminance) const;
    // The same for the whole picture. `fog` >= 0.
    void render(std::span<const glm::vec3> levels, std::span<const ProjectedLight> frames, double fog,
                Image<glm::vec3>& luminance) const {
        render({levels, frames, fog}, {0, luminance.height()}, luminance);
    }

private:
    static constexpr int kSide = 2;  // samples across and down a camera pixel
    static constexpr float kShare = 1.0f / (kSide * kSide);

    // What a sample ray of the camera hits.
    struct Sample {
        std::uint32_t pixel;
        float distance;   // from the camera, metres
        float footprint;  // the surface that the sample represents, m2
        glm::vec3 point, normal;
        glm::vec3 response;  // cd/m2 in the pixel per lux here: the sample's share of reflectance / pi
    };
    // A steady light at full power, one entry per pixel: cd/m2 in rgb, and in w the metres that the
    // light has travelled to the camera.
    struct Layer {
        Image<glm::vec4> light;
        glm::vec3 meanIlluminance{0};  // lux, over the surfaces in view; it lights the fog between them
    };
    // The place in a projector's frame whose light one sample sees.
    struct Tap {
        std::uint32_t pixel;
        ProjectedLight::Place place;
        glm::vec3 weight;  // cd/m2 for a white frame
        float path;        // metres from the lens to the surface to the camera
    };
    struct Projector {
        double lumens = 0;
        std::vector<Tap> taps;
        float meanIlluminance = 0;  // lux of a white frame
    };

    glm::vec3 airlight(const Lighting& lighting) const;  // cd/m2 of fog so thick that nothing is seen through it

    const Scene& scene_;
    vision::CameraModel camera_;
    std::vector<Sample> samples_;
    Layer steady_;  // ambient light and sky; w: how far the camera sees
    std::vector<Layer> lamps_;
    std::vector<Projector> projectors_;
};

}  // namespace fantascope::site
