#pragma once

#include "drivers/site/body.h"
#include "drivers/site/lamp.h"
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

// What shines at one moment.
struct Lighting {
    std::span<const glm::vec3> levels;       // of the lamps: linear, 1 is full power
    std::span<const ProjectedLight> frames;  // of the projectors
    double fog = 0;                          // extinction per metre
    float ambient = 1;                       // times the ambient light and the sky
    std::span<const Body> bodies = {};       // in front of the scene
    std::span<const Lamp> passing = {};      // lamps that move, at full power; the scene throws no shadow in their light
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

    // Prepares for Lighting::bodies. Call once, before the first render() that has any.
    void expectBodies();

    // Fills the rows of `luminance` (cd/m2, the camera's size). Fog weakens light along its whole
    // way, and the lit fog veils distant surfaces. A body hides what is behind it and throws its
    // shadow into the projectors' light, but not into the lamps'. Ambient light, lamps and
    // projectors light it.
    void render(const Lighting& lighting, Rows rows, Image<glm::vec3>& luminance) const;
    // The same for the whole picture. `fog` >= 0.
    void render(std::span<const glm::vec3> levels, std::span<const ProjectedLight> frames, double fog,
                Image<glm::vec3>& luminance) const {
        render({levels, frames, fog}, {0, luminance.height()}, luminance);
    }

private:
    static constexpr int kSide = 2;  // samples across and down a camera pixel
    static constexpr std::uint32_t kSamples = kSide * kSide;
    static constexpr float kShare = 1.0f / kSamples;

    // What a sample ray of the camera hits. Samples are numbered in the order of the pixels,
    // kSamples for each; those that hit nothing are left out.
    struct Sample {
        std::uint32_t index;
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
        std::uint32_t index;  // of the sample
        ProjectedLight::Place place;
        glm::vec3 weight;  // cd/m2 for a white frame
        float path;        // metres from the lens to the surface to the camera
    };
    // Where a tap's light falls, and by which pixel of the projector it goes there.
    struct LitPoint {
        glm::vec2 pixel;
        glm::vec3 point;
    };
    struct Projector {
        double lumens = 0;
        vision::CameraModel model = {};
        std::vector<Tap> taps = {};      // in the order of the samples
        std::vector<LitPoint> lit = {};  // of the taps; empty unless bodies are expected
        float meanIlluminance = 0;       // lux of a white frame
    };
    // A sample's ray, and how far it goes before it meets the scene, metres.
    struct Sight {
        glm::vec3 direction{0};
        float distance = 0;
    };
    // Which samples see which bodies.
    struct Covering {
        static constexpr std::uint32_t kNobody = 0xffffffff;
        struct Seen {
            std::uint32_t index = 0;  // of the sample
            double distance = 0;      // from the camera, metres
            std::size_t body = 0, part = 0;
        };
        std::uint32_t first = 0;            // number of the first sample in seenBy
        std::vector<std::uint32_t> seenBy;  // index in `seen`, or kNobody; empty without bodies
        std::vector<Seen> seen;

        bool hides(std::uint32_t sample) const { return !seenBy.empty() && seenBy[sample - first] != kNobody; }
        // Whether a body is nearer than `distance`.
        bool hides(std::uint32_t sample, double distance) const {
            return hides(sample) && seen[seenBy[sample - first]].distance < distance;
        }
    };
    // A place on a body that a sample sees.
    struct BodyPoint {
        std::uint32_t index = 0;  // of the sample
        double distance = 0;      // from the camera, metres
        std::size_t part = 0;
        double along = 0;  // the part's line, 0..1
        glm::dvec3 point{0.0}, normal{0.0};
        double cosine = 0;   // between the normal and the view
        glm::vec3 light{0};  // cd/m2 per reflectance / pi that arrive at the camera
    };
    using BodyPoints = std::vector<BodyPoint>;

    glm::vec3 airlight(const Lighting& lighting) const;  // cd/m2 of fog so thick that nothing is seen through it

    vision::Ray rayOf(std::uint32_t sample) const;
    // Calls add(sample, cd/m2 in the pixel, metres to the camera) for each sample that sees a
    // lamp's luminous head.
    template <class Add>
    void drawHead(const Lamp& lamp, Add add) const;
    glm::vec3 meanIlluminanceOf(const Lamp& passing) const;  // lux, over the surfaces in view
    void addPassing(const Lamp& lamp, const Lighting& lighting, const Covering& covering, Rows rows,
                    Image<glm::vec3>& luminance) const;
    void noteLitPoints(Projector& projector) const;
    Covering coveringOf(std::span<const Body> bodies, Rows rows) const;
    void hideBehind(const Covering& covering, Image<glm::vec3>& luminance) const;
    void addProjector(std::size_t projector, const Lighting& lighting, const Covering& covering, Rows rows,
                      Image<glm::vec3>& luminance) const;
    void addBodies(const Lighting& lighting, const Covering& covering, glm::vec3 inTheAir, Image<glm::vec3>& luminance) const;
    void lightByLamp(BodyPoints& points, const Body& body, const Lamp& lamp, glm::vec3 level, double fog) const;
    void lightByProjector(BodyPoints& points, std::size_t body, std::size_t projector, const Lighting& lighting) const;

    const Scene& scene_;
    vision::CameraModel camera_;
    std::vector<Sample> samples_;
    Layer steady_;  // ambient light and sky; w: how far the camera sees
    std::vector<Layer> lampLayers_;
    std::vector<Lamp> lamps_;
    std::vector<Projector> projectors_;
    std::vector<Sight> sights_;  // by sample; empty unless bodies are expected
};

}  // namespace fantascope::site
