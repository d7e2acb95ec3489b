#pragma once

#include "pattern/motion/pattern_motion.h"
#include "pattern/shape/shape_pattern.h"
#include "render/source/picture_feed.h"
#include "render/source/video_stream.h"
#include "show/source_id.h"
#include "show/source_kinds.h"

#include "core/clock.h"
#include "core/fit.h"
#include "media/image.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
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
};

// These need nothing beside what the author says.
using show::CausticsSource;
using show::MirrorBallSource;
using show::SolidSource;

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
};

// A picture that stands still.
struct ImageSource {
    std::shared_ptr<const RgbaImage> picture;  // stored sRGB values, straight alpha
};

// A video; its stream is shared by the outputs that show it. Once it is over, its last frame stays.
struct VideoSource {
    std::shared_ptr<VideoStream> stream;
    bool loop = true;
    double speed = 1;  // positive
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
};
// The moment of the cast's motion that is seen at a layer's time `time`, in frames from the first.
double frameAt(const ShadowSource& source, Time time);
// How long the motion takes, there and back where it plays so; 0: a still.
Time lengthOf(const ShadowSource& source);

// What a camera sees; nothing before its first picture.
struct CameraSource {
    std::shared_ptr<PictureFeed> feed;
};

// What a kind of the show's is once its files are read. A new kind needs its line here.
template <class Kind>
struct LoadedKind;
template <>
struct LoadedKind<show::PatternSource> : std::type_identity<PatternSource> {};
template <>
struct LoadedKind<show::SolidSource> : std::type_identity<SolidSource> {};
template <>
struct LoadedKind<show::FoliageSource> : std::type_identity<FoliageSource> {};
template <>
struct LoadedKind<show::CausticsSource> : std::type_identity<CausticsSource> {};
template <>
struct LoadedKind<show::MirrorBallSource> : std::type_identity<MirrorBallSource> {};
template <>
struct LoadedKind<show::ImageSource> : std::type_identity<ImageSource> {};
template <>
struct LoadedKind<show::VideoSource> : std::type_identity<VideoSource> {};
template <>
struct LoadedKind<show::CameraSource> : std::type_identity<CameraSource> {};
template <>
struct LoadedKind<show::ShadowSource> : std::type_identity<ShadowSource> {};

template <class Kinds>
struct LoadedKinds;
template <class... Kinds>
struct LoadedKinds<std::variant<Kinds...>> {
    using Variant = std::variant<typename LoadedKind<Kinds>::type...>;
    template <class Kind>
    static constexpr bool kHas = (std::is_same_v<Kind, typename LoadedKind<Kinds>::type> || ...);
};

// What a layer can show, and how it fits on a canvas of another shape.
struct PictureSource {
    using Kinds = LoadedKinds<show::SourceKind>;

    template <class Kind>
    requires Kinds::kHas<Kind> PictureSource(Kind kind, Fit fit = Fit::Contain) : picture(std::move(kind)), fit(fit) {}

    Kinds::Variant picture;
    Fit fit;
};

// All that an output can show.
using PictureSources = show::BySource<PictureSource>;

// Width / height of a source's own picture; nothing where it has no shape.
std::optional<double> aspectOf(const PictureSource& source);

// Where on a canvas (width / height; 0: the source's own shape) a source lies.
CanvasPart placeOf(const PictureSource& source, double canvasAspect);

}  // namespace fantascope::render
