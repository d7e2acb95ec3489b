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

// Light of one colour channel is counted in photometric units that white light of the same strength
// has: lux on a surface, candela per square metre from it, both linear.

// A lamp: a small round head whose light falls off from its aim. The intensity at an angle from the
// aim is candela * exp(-(angle / a)^p), with a and p such that it is a half at half the beam angle
// and a tenth at half the field angle, as those are defined (ANSI E1.9).
struct Lamp {
    glm::dvec3 position{0.0};        // metres
    glm::dvec3 aim{0, -1, 0};        // unit
    double beam = 0.4, field = 0.6;  // full angles, radians; field > beam
    glm::dvec3 colour{1.0};          // linear RGB, 0..1
    double candela = 1000;           // along the aim
    double radius = 0.1;             // of the luminous head, metres

    double intensity(glm::dvec3 direction) const;  // candela towards a unit direction
};

// What the camera sees of a scene, as a sum over its lights. How much of each light arrives at each
// pixel is worked out beforehand (direct light on matt surfaces, with shadows); a picture is then
// one pass over those weights. Thread-bound.
class CameraView {
public:
    // `scene` outlives the view. `ambient`: lux on every surface; `sky`: cd/m2 where there is none.
    CameraView(const Scene& scene, const vision::CameraModel& camera, glm::dvec3 ambient, glm::dvec3 sky);

    // Lamps count from 0 in the order in which they are added, projectors too.
    void addLamp(const Lamp& lamp);
    // `lumens`: of a full white picture, spread evenly over the picture on a wall that the lens
    // faces squarely.
    void addProjector(const vision::CameraModel& projector, double lumens);
    // Works out one projector's light again. Some tens of milliseconds.
    void moveProjector(std::size_t projector, const vision::CameraModel& model);

    // Fills `luminance` (cd/m2, the camera's size) at the lamps' levels (linear, 1 is full power)
    // and the projectors' frames. `fog`: extinction per metre, >= 0; it weakens light on its whole
    // way and, lit by the same lights, lays a veil over the distance.
    void render(std::span<const glm::vec3> levels, std::span<const ProjectedLight> frames, double fog,
                Image<glm::vec3>& luminance) const;

private:
    static constexpr int kSide = 2;  // samples across and down a camera pixel
    static constexpr float kShare = 1.0f / (kSide * kSide);

    // What one sample ray of the camera met.
    struct Sample {
        std::uint32_t pixel;
        float distance;   // from the camera, metres
        float footprint;  // the surface that the sample stands for, m2
        glm::vec3 point, normal;
        glm::vec3 response;  // cd/m2 that the pixel sees for one lux here: the sample's share of reflectance / pi
    };
    // A steady light at full power, one entry a pixel: cd/m2 in rgb, and in w the metres that it
    // has travelled when it reaches the camera.
    struct Layer {
        Image<glm::vec4> light;
        glm::vec3 meanIlluminance{0};  // lux, over the surfaces in view: what the air between them is lit with in fog
    };
    // Where in a projector's frame the light comes from that one sample sees.
    struct Tap {
        std::uint32_t pixel;
        ProjectedLight::Place place;
        glm::vec3 weight;  // cd/m2 for a white frame
        float path;        // metres from the lens over the surface to the camera
    };
    struct Projector {
        double lumens = 0;
        std::vector<Tap> taps;
        float meanIlluminance = 0;  // lux of a white frame
    };

    const Scene& scene_;
    vision::CameraModel camera_;
    std::vector<Sample> samples_;
    Layer steady_;  // ambient light and sky; w: how far the camera sees
    std::vector<Layer> lamps_;
    std::vector<Projector> projectors_;
};

}  // namespace fantascope::site
