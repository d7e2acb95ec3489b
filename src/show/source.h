#pragma once

#include "core/config.h"
#include "core/file_place.h"
#include "core/fit.h"
#include "core/result.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace fantascope::show {

// Where a layer's picture comes from; docs/show-format.md has the keys. Files exist; what is in
// them was not looked at.

struct PatternSource {
    std::filesystem::path file;  // a *.pattern.yaml
};
struct SolidSource {
    glm::vec3 colour{0.0f};  // linear light, 0..1
};

// Light through leaves (Ji et al. 2015, section 5).
struct FoliageSource {
    struct Layer {
        std::filesystem::path pattern;
        bool holes = false;                           // the pattern's shapes are holes in a dark canopy, and no leaves
        double distance = 0;                          // metres from the leaves to what their shadow falls on
        std::optional<std::filesystem::path> filter;  // a picture of what one small hole throws; without it a disc
    };
    glm::dvec3 light{1.0}, shadow{0.0};  // linear light; `light` may exceed 1
    double height = 1;                   // of the canvas where it falls, metres
    double sun = 0;                      // the angle that the sun appears under, radians
    std::vector<Layer> layers;
};

// Sunlight under water. The numbers are those of render::CausticsSource.
struct CausticsSource {
    glm::dvec3 light{0.1, 0.15, 0.17};
    glm::dvec2 size{16.0 / 3, 3};
    double depth = 1.2, waveLength = 0.55, waveHeight = 0.02;
    std::uint64_t seed = 1;
};

// Spots of a mirror ball. The numbers are those of render::MirrorBallSource.
struct MirrorBallSource {
    glm::dvec3 light{3.0};
    glm::dvec2 size{16.0 / 3, 3};
    glm::dvec3 ball{0, 0.5, 2.2}, lamp{2.6, 1.8, 1.0};
    double radius = 0.25, facet = 0.017, lampRadius = 0.03, turn = 60;
};

struct ImageSource {
    std::filesystem::path file;
};
// The numbers are those of render::VideoSource.
struct VideoSource {
    std::filesystem::path file;
    bool loop = true;
    double speed = 1;
};
// What the site's camera sees.
struct CameraSource {};

// Shadow theatre. The numbers are those of render::ShadowSource.
struct ShadowSource {
    struct Lamp {
        std::optional<glm::dvec3> at;  // stage frame, metres; none: the beam's light
        double size = 0;
        glm::dvec3 light{1}, shadow{0};
        std::vector<glm::dvec3> actors;
    };
    enum class Play { Once, Loop, ToAndFro };
    struct Picture {
        glm::dvec2 x{0}, y{0};  // from, to; metres on the screen
    };
    std::filesystem::path cast;  // a *.cast.yaml
    int beam = 1;                // of the cast's stage, whose screen is seen
    std::vector<Lamp> lamps;     // the beam's own first
    int samples = 16;
    std::optional<Play> play;  // none: a loop if the silhouette moves in one, else once
    double speed = 1;
    std::optional<Picture> picture;  // what the canvas is of the screen; none: the target's picture
};

struct Source {
    std::string name;
    std::variant<PatternSource, SolidSource, FoliageSource, CausticsSource, MirrorBallSource, ImageSource, VideoSource,
                 CameraSource, ShadowSource>
        picture;
    FilePlace at;  // for whoever has to refuse what is in its files
    Fit fit = Fit::Contain;
};

// One entry of a show's `sources`. Strict; the files that it names must exist. Error: place, key,
// advice.
Result<Source> readSource(const std::string& name, const ConfigNode& node);

// All files that a source names and that can be checked by themselves: patterns, images, videos,
// casts.
std::vector<std::filesystem::path> filesOf(const Source& source);

}  // namespace fantascope::show
