#pragma once

#include "pattern/motion/pattern_motion.h"
#include "pattern/shape/shape_pattern.h"
#include "render/source/pattern_rests.h"
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

// A light pattern, shared by the outputs that show it.
struct PatternSource {
    std::shared_ptr<const pattern::ShapePattern> pattern;
    std::shared_ptr<const pattern::PatternMotion> motion;  // null: the shapes rest
    std::shared_ptr<const PatternRests> rests = nullptr;   // of an exchange, whose all() is `pattern`; null: there is none
};

// These need nothing beside what the author says.
using show::CausticsSource;
using show::MirrorBallSource;
using show::SolidSource;

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
    glm::vec3 light{1};               // where nothing keeps it off: linear light, may exceed 1 where holes make little of it
    glm::vec3 shadow{0};              // what is left in full shadow
    std::vector<ShadowLayer> layers;  // at least one; all patterns of one aspect; holes are blurred
};

// A still picture.
struct ImageSource {
    std::shared_ptr<const RgbaImage> picture;  // stored sRGB values, straight alpha
};

// A video, whose stream is shared by the outputs that show it.
struct VideoSource {
    std::shared_ptr<VideoStream> stream;
    Time from{};               // where it begins, in the video
    std::optional<Time> to{};  // where it ends, after `from`; none, or later than that: the video's end
    int times = 0;             // so often it plays; 0: for ever
    bool endsDark = false;     // after that nothing is seen, else its last frame
    double speed = 1;          // positive
};
// The position in the video at layer time `time`; nothing: it is over, and dark.
std::optional<Time> positionAt(const VideoSource& source, Time time);

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
};
// The position in the cast's motion at layer time `time`, in frames since the first.
double frameAt(const ShadowSource& source, Time time);
// The duration of the motion, there and back if it plays so; 0: a still.
Time lengthOf(const ShadowSource& source);

// A camera's picture; nothing before the first one.
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

// For how long the sources play that come to an end: videos that play so many times, and shadows
// that play once.
show::PlayLengths playLengthsOf(const PictureSources& sources);

// Width / height of a source's own picture; nothing for a source without an aspect.
std::optional<double> aspectOf(const PictureSource& source);

// The part of a canvas that a source covers. `canvasAspect`: width / height; 0: the source's own.
CanvasPart placeOf(const PictureSource& source, double canvasAspect);

}  // namespace fantascope::render
