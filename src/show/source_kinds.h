#pragma once
// The kinds of source, as a show's author asks for them: plain values. SourceKind is their only
// list. Code that handles every kind visits it by type, so a new kind does not compile until it is
// handled everywhere. docs/show-format.md describes the keys; kKey is the key of a kind.

#include "core/clock.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

namespace fantascope::show {

// A light pattern.
struct PatternSource {
    static constexpr std::string_view kKey = "pattern";
    std::filesystem::path file;  // a *.pattern.yaml
    friend bool operator==(const PatternSource&, const PatternSource&) = default;
};

// The whole canvas in one colour.
struct SolidSource {
    static constexpr std::string_view kKey = "solid";
    glm::vec3 colour{1};  // linear light, 0..1
    friend bool operator==(const SolidSource&, const SolidSource&) = default;
};

// Light through leaves (Ji et al. 2015, section 5).
struct FoliageSource {
    static constexpr std::string_view kKey = "foliage";
    struct Layer {
        std::filesystem::path pattern;
        bool holes = false;                           // the pattern's shapes are holes in a dark canopy, not leaves
        double distance = 0;                          // metres from the leaves to the surface of their shadow
        std::optional<std::filesystem::path> filter;  // a picture of what one small hole projects; none: a disc
        friend bool operator==(const Layer&, const Layer&) = default;
    };
    glm::dvec3 light{1.0}, shadow{0.0};  // linear light; `light` may exceed 1
    double height = 1;                   // of the canvas on the wall or ground, metres
    double sun = 0;                      // apparent diameter of the sun, radians
    std::vector<Layer> layers;
    friend bool operator==(const FoliageSource&, const FoliageSource&) = default;
};

// Sunlight on the floor under wavy water: the waves focus and scatter it.
struct CausticsSource {
    static constexpr std::string_view kKey = "caustics";
    glm::vec3 light{0.1f, 0.15f, 0.17f};  // under still water, linear light; the bright lines have several times as much
    glm::dvec2 size{16.0 / 3, 3};         // of the canvas on the floor, metres
    double depth = 1.2;                   // of the water, metres
    double waveLength = 0.55;             // metres, on average
    double waveHeight = 0.02;             // metres, root mean square
    std::uint64_t seed = 1;
    friend bool operator==(const CausticsSource&, const CausticsSource&) = default;
};

// The spots of a mirror ball that turns in a lamp's beam, on a wall. Places are metres from the
// canvas's middle: right, up, out of the wall.
struct MirrorBallSource {
    static constexpr std::string_view kKey = "mirror_ball";
    glm::vec3 light{3};              // of a spot seen straight on, as far from the lamp as the wall behind the ball; linear light
    glm::dvec2 size{16.0 / 3, 3};    // of the canvas on the wall, metres
    glm::dvec3 ball{0, 0.5, 2.2};    // its centre; in front of the wall
    double radius = 0.25;            // metres
    double facet = 0.017;            // a mirror's edge, metres
    glm::dvec3 lamp{2.6, 1.8, 1.0};  // outside the ball, in front of the wall
    double lampRadius = 0.03;        // metres
    double turn = 60;                // seconds for one turn; negative: the other way round
    friend bool operator==(const MirrorBallSource&, const MirrorBallSource&) = default;
};

// A still picture.
struct ImageSource {
    static constexpr std::string_view kKey = "image";
    std::filesystem::path file;
    friend bool operator==(const ImageSource&, const ImageSource&) = default;
};

// A video, or a part of it. The numbers have the meaning of render::VideoSource's.
struct VideoSource {
    static constexpr std::string_view kKey = "video";
    std::filesystem::path file;
    Time from{};
    std::optional<Time> to;  // none: the video's end
    int times = 0;
    bool endsDark = false;
    double speed = 1;
    friend bool operator==(const VideoSource&, const VideoSource&) = default;
};

// What the site's camera sees.
struct CameraSource {
    static constexpr std::string_view kKey = "camera";
    friend bool operator==(const CameraSource&, const CameraSource&) = default;
};

// Shadow theatre. The numbers have the meaning of render::ShadowSource's.
struct ShadowSource {
    static constexpr std::string_view kKey = "shadow";
    struct Lamp {
        std::optional<glm::dvec3> at;  // stage frame, metres; none: the beam's light
        double size = 0;
        glm::dvec3 light{1}, shadow{0};
        std::vector<glm::dvec3> actors;
        friend bool operator==(const Lamp&, const Lamp&) = default;
    };
    enum class Play { Once, Loop, ToAndFro };
    struct Picture {
        glm::dvec2 x{0}, y{0};  // from, to; metres on the screen
        friend bool operator==(const Picture&, const Picture&) = default;
    };
    std::filesystem::path cast;  // a *.cast.yaml
    int beam = 1;                // the beam of the cast's stage whose screen is seen
    std::vector<Lamp> lamps;     // the beam's own first
    int samples = 16;
    std::optional<Play> play;  // none: Loop if the silhouette moves in a loop, else Once
    double speed = 1;
    std::optional<Picture> picture;  // the part of the screen that the canvas shows; none: the target's picture
    friend bool operator==(const ShadowSource&, const ShadowSource&) = default;
};

using SourceKind = std::variant<PatternSource, SolidSource, FoliageSource, CausticsSource, MirrorBallSource, ImageSource,
                                VideoSource, CameraSource, ShadowSource>;

}  // namespace fantascope::show
