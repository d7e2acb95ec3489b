#pragma once

#include "pattern/motion/pattern_motion.h"
#include "pattern/shape/shape_pattern.h"
#include "render/source/picture_feed.h"
#include "render/source/video_stream.h"

#include "core/clock.h"
#include "core/fit.h"
#include "media/image.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

namespace fantascope::theatre {
struct Cast;
}

namespace fantascope::render {

// A light pattern, shared by the outputs that show it.
struct PatternSource {
    std::shared_ptr<const pattern::ShapePattern> pattern;
    std::shared_ptr<const pattern::PatternMotion> motion;  // null: the shapes stand still
    Fit fit = Fit::Contain;
};

// The whole canvas in one colour.
struct SolidSource {
    glm::vec3 colour{1};  // linear light, 0..1
};

// The picture that a small hole throws, with which every edge is blurred.
struct ShadowFilter {
    double width = 0;                          // canvas heights; 0: sharp
    std::shared_ptr<const GreyImage> picture;  // linear light, upright as seen on the canvas, `width` wide; null: a disc
};

// Leaves at one distance from the canvas.
struct ShadowLayer {
    PatternSource leaves;
    ShadowFilter filter;
    bool holes = false;  // the shapes are holes in an opaque layer
};

// The light that falls through layers of leaves: the product of the layers' transmission. Where
// there is no shape, also beyond the canvas, a layer of leaves transmits everything and a layer of
// holes nothing. Source: Ji et al. 2015, section 5.
struct FoliageSource {
    glm::vec3 light{1};               // without shadow: linear light; may exceed 1, since holes let little of it through
    glm::vec3 shadow{0};              // in full shadow: linear light
    std::vector<ShadowLayer> layers;  // at least one; all patterns have the same aspect; layers of holes are blurred
    Fit fit = Fit::Contain;           // of all layers together
};

// Caustics: sunlight that waves focus and scatter on the floor under water.
struct CausticsSource {
    glm::vec3 light{1};     // under still water: linear light; the bright lines are several times brighter
    glm::dvec2 size{1};     // of the canvas on the floor, metres
    double depth = 0;       // of the water, metres
    double waveLength = 1;  // metres, on average
    double waveHeight = 0;  // metres, root mean square
    std::uint64_t seed = 1;
    Fit fit = Fit::Contain;
};

// The spots that a mirror ball turning in a lamp's beam throws on a wall. Places are in metres from
// the canvas's middle: right, up, out of the wall.
struct MirrorBallSource {
    glm::vec3 light{1};     // of a spot at the same distance as the wall behind the ball, at normal incidence: linear light
    glm::dvec2 size{1};     // of the canvas on the wall, metres
    glm::dvec3 ball{0};     // its centre; in front of the wall
    double radius = 0;      // metres
    double facet = 0;       // a mirror's edge, metres
    glm::dvec3 lamp{0};     // outside the ball, in front of the wall
    double lampRadius = 0;  // metres
    double turn = 1;        // seconds per turn; negative: the other way round
    Fit fit = Fit::Contain;
};

// A still picture.
struct ImageSource {
    std::shared_ptr<const RgbaImage> picture;  // stored sRGB values, straight alpha
    Fit fit = Fit::Contain;
};

// A video, whose stream is shared by the outputs that show it. After its end, its last frame stays.
struct VideoSource {
    std::shared_ptr<VideoStream> stream;
    bool loop = true;
    double speed = 1;  // positive
    Fit fit = Fit::Contain;
};
// The position in the video at layer time `time`.
Time positionAt(const VideoSource& source, Time time);

// Shadow theatre: a cast's moving people between lamps and a screen. The lamps' light adds up.
// Source: Won & Lee 2016; section 7 for soft light and several lights.
struct ShadowSource {
    struct Lamp {
        glm::dvec3 place{0};            // stage frame, metres
        double size = 0;                // its diameter, facing the screen, metres; 0: a point
        glm::vec3 light{1}, shadow{0};  // the screen's linear light where the lamp shines, and in shadow
        std::vector<glm::vec3> actors;  // per actor: his shadow's colour where he is nearest to the lamp; empty: `shadow`
    };
    enum class Play {
        Once,  // the last frame stays
        Loop,  // the first frame follows the last
        ToAndFro
    };
    std::shared_ptr<const theatre::Cast> cast;
    std::size_t beam = 0;       // index of the stage's beam whose screen the canvas lies on
    std::vector<Lamp> lamps;    // at least one
    glm::dvec2 from{0}, to{1};  // the canvas's lower left and upper right corners on the screen, unrolled if curved; metres
    int samples = 16;           // points of light per lamp that has a size
    Play play = Play::Once;
    double speed = 1;  // positive
    Fit fit = Fit::Contain;
};
// The position in the cast's motion at layer time `time`, in frames since the first.
double frameAt(const ShadowSource& source, Time time);
// The duration of the motion, there and back if it plays so; 0: a still.
Time lengthOf(const ShadowSource& source);

// A camera's picture; nothing before the first one.
struct CameraSource {
    std::shared_ptr<PictureFeed> feed;
    Fit fit = Fit::Contain;
};

// What a layer can show, in the order of Show::sources.
using PictureSource = std::variant<PatternSource, SolidSource, FoliageSource, CausticsSource, MirrorBallSource, ImageSource,
                                   VideoSource, CameraSource, ShadowSource>;

// Width / height of a source's own picture; nothing for a source without an aspect.
std::optional<double> aspectOf(const PictureSource& source);

// The part of a canvas that a source covers. `canvasAspect`: width / height; 0: the source's own.
CanvasPart placeOf(const PictureSource& source, double canvasAspect);

// The source with another fit. A source without an aspect is returned as it is.
PictureSource fitted(PictureSource source, Fit fit);

}  // namespace fantascope::render
