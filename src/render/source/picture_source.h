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

// A light pattern; shared by the outputs that show it.
struct PatternSource {
    std::shared_ptr<const pattern::ShapePattern> pattern;
    std::shared_ptr<const pattern::PatternMotion> motion;  // null: the shapes rest
    Fit fit = Fit::Contain;
};

// The whole canvas in one colour.
struct SolidSource {
    glm::vec3 colour{1};  // linear light, 0..1
};

// What a point of light through a hole becomes, and so what every edge is blurred with.
struct ShadowFilter {
    double width = 0;                          // canvas heights; 0: sharp
    std::shared_ptr<const GreyImage> picture;  // linear light, upright as it falls on the canvas, `width` wide; null: a disc
};

// Leaves at one distance, in the light.
struct ShadowLayer {
    PatternSource leaves;
    ShadowFilter filter;
    bool holes = false;  // the shapes are holes in what lets no other light through
};

// The light that falls through layers of leaves: the product of what each lets through. Where no
// shape is, beyond the canvas too, a layer of leaves lets all of it through and one of holes none.
// Source: Ji et al. 2015, section 5.
struct FoliageSource {
    glm::vec3 light{1};               // where nothing keeps it off: linear light, may exceed 1 where holes make little of it
    glm::vec3 shadow{0};              // what is left in full shadow
    std::vector<ShadowLayer> layers;  // at least one; all patterns of one aspect; holes are blurred
    Fit fit = Fit::Contain;           // of all layers together
};

// Sunlight on the floor of wavy water, as the waves gather and scatter it.
struct CausticsSource {
    glm::vec3 light{1};     // of still water: linear light; the bright lines have several times as much
    glm::dvec2 size{1};     // of the canvas on the floor, metres
    double depth = 0;       // of the water, metres
    double waveLength = 1;  // metres, on average
    double waveHeight = 0;  // metres, root mean square
    std::uint64_t seed = 1;
    Fit fit = Fit::Contain;
};

// The spots of a mirror ball that turns in a lamp's beam, on a wall. Places are metres from the
// canvas's middle: right, up, out of the wall.
struct MirrorBallSource {
    glm::vec3 light{1};     // of a spot as far from the lamp as the wall behind the ball, and as straight: linear light
    glm::dvec2 size{1};     // of the canvas on the wall, metres
    glm::dvec3 ball{0};     // its centre; before the wall
    double radius = 0;      // metres
    double facet = 0;       // a mirror's edge, metres
    glm::dvec3 lamp{0};     // outside the ball, before the wall
    double lampRadius = 0;  // metres
    double turn = 1;        // seconds for one turn; below 0 the other way round
    Fit fit = Fit::Contain;
};

// A picture that stands still.
struct ImageSource {
    std::shared_ptr<const RgbaImage> picture;  // stored sRGB values, straight alpha
    Fit fit = Fit::Contain;
};

// A video; its stream is shared by the outputs that show it. Once it is over, its last frame stays.
struct VideoSource {
    std::shared_ptr<VideoStream> stream;
    bool loop = true;
    double speed = 1;  // positive
    Fit fit = Fit::Contain;
};
// The moment of the video that is seen at a layer's time `time`.
Time positionAt(const VideoSource& source, Time time);

// Shadow theatre: a cast's people between lamps and the screen, as they move. Lamps' light adds up.
// Source: Won & Lee 2016; soft light and several lights are of its section 7.
struct ShadowSource {
    struct Lamp {
        glm::dvec3 place{0};            // stage frame, metres
        double size = 0;                // its diameter, facing the screen, metres; 0: a point
        glm::vec3 light{1}, shadow{0};  // what the screen is where it shines, and where somebody keeps it off: linear light
        std::vector<glm::vec3>
            actors;  // the shadow of each actor, where he is the nearest to the lamp; empty: all throw `shadow`
    };
    enum class Play {
        Once,  // then the last frame stays
        Loop,  // after the last frame comes the first
        ToAndFro
    };
    std::shared_ptr<const theatre::Cast> cast;
    std::size_t beam = 0;     // of its stage, whose screen the canvas lies on
    std::vector<Lamp> lamps;  // at least one
    glm::dvec2 from{0},
        to{1};         // the canvas's lower left and upper right corner on the screen, which is unrolled if it is curved; metres
    int samples = 16;  // points of light in a lamp that has a size
    Play play = Play::Once;
    double speed = 1;  // positive
    Fit fit = Fit::Contain;
};
// The moment of the cast's motion that is seen at a layer's time `time`, in frames from the first.
double frameAt(const ShadowSource& source, Time time);
// How long the motion takes, there and back where it plays so; 0: a still.
Time lengthOf(const ShadowSource& source);

// What a camera sees; nothing before its first picture.
struct CameraSource {
    std::shared_ptr<PictureFeed> feed;
    Fit fit = Fit::Contain;
};

// What a layer can show, in the order of Show::sources.
using PictureSource = std::variant<PatternSource, SolidSource, FoliageSource, CausticsSource, MirrorBallSource, ImageSource,
                                   VideoSource, CameraSource, ShadowSource>;

// Width / height of a source's own picture; nothing where it has no shape.
std::optional<double> aspectOf(const PictureSource& source);

// Where on a canvas (width / height; 0: the source's own shape) a source lies.
CanvasPart placeOf(const PictureSource& source, double canvasAspect);

// A source that fits otherwise. What has no shape stays as it is.
PictureSource fitted(PictureSource source, Fit fit);

}  // namespace fantascope::render
