#include "show/source.h"

#include "core/geometry.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

namespace fantascope::show {
namespace {

namespace fs = std::filesystem;

// The sun's apparent diameter (Ji et al. 2015, section 5.1, have 0.5 degrees).
constexpr double kSun = radians(0.53);

// Limits. Metres, seconds.
constexpr double kSmallest = 0.001, kLargest = 1000;
constexpr double kWidestBlur = 2;  // canvas heights
constexpr std::size_t kMostLayers = 8;
constexpr double kBrightest = 100;
constexpr double kShortestWave = 1.0 / 20;   // canvas heights
constexpr double kSteepestWave = 0.1;        // height to length
constexpr double kSmallestFacet = 1.0 / 50;  // of the ball's radius
constexpr double kLongestTurn = 3600;
constexpr double kSlowest = 0.01, kFastest = 10;  // videos, casts
constexpr double kLongestVideo = 86400;           // seconds
constexpr int kMostTimes = 10000;
constexpr double kWidestLamp = 2;  // metres
constexpr int kMostSamples = 128;
constexpr std::size_t kMostLamps = 8, kMostActors = 50, kMostBeams = 8;

Result<fs::path> readFile(const ConfigNode& node, std::string_view advice) {
    const fs::path file = TRY(node.path());
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) return node.error(fmt::format("there is no file {}; {}", file.string(), advice));
    return file;
}

Result<fs::path> readPatternFile(const ConfigNode& node) {
    return readFile(node, fmt::format("make it with 'fantascope pattern GUIDE -o {}'", TRY(node.path()).string()));
}

// Reads the value of a kind's key.
template <class Kind>
Result<Kind> readAs(const ConfigNode& node) = delete;

template <>
Result<PatternSource> readAs(const ConfigNode& node) {
    return PatternSource{TRY(readPatternFile(node))};
}

template <>
Result<SolidSource> readAs(const ConfigNode& node) {
    return SolidSource{glm::vec3(TRY(node.vector3(0, 1)))};
}

template <>
Result<ImageSource> readAs(const ConfigNode& node) {
    return ImageSource{TRY(readFile(node, "it is a picture (PNG, JPEG or TIFF)"))};
}

Result<FoliageSource::Layer> readLeaves(const ConfigNode& node, const FoliageSource& foliage) {
    FoliageSource::Layer layer;
    std::optional<fs::path> leaves, holes;
    ConfigFields fields(node);
    fields.optional().read("leaves", leaves, [](const ConfigNode& file) {
        return readFile(file, "make it with 'fantascope pattern GUIDE -o LEAVES.pattern.yaml --shadows'");
    });
    fields.optional().read("holes", holes, readPatternFile);
    fields.number("distance", layer.distance, 0, kLargest, "m");
    fields.optional().read("filter", layer.filter, [](const ConfigNode& file) {
        return readFile(file, "it is a picture (PNG, JPEG or TIFF) of the light that one small hole throws");
    });
    TRY(fields.finish());
    if (leaves.has_value() == holes.has_value()) return node.error("exactly one of 'leaves' and 'holes' is needed");
    layer.holes = holes.has_value();
    layer.pattern = leaves ? *leaves : *holes;
    const double blur = layer.distance * std::tan(foliage.sun) / foliage.height;
    if (blur > kWidestBlur)
        return node.error(
            fmt::format("from {} m away the sun is blurred over {:.1f} times the canvas's height; at most {} times; "
                        "take a smaller 'distance' or 'sun'",
                        layer.distance, blur, kWidestBlur));
    return layer;
}

template <>
Result<FoliageSource> readAs(const ConfigNode& node) {
    FoliageSource foliage;
    foliage.sun = kSun;
    std::vector<ConfigNode> layers;
    ConfigFields fields(node);
    fields.number("height", foliage.height, kSmallest, kLargest, "m");
    fields.optional().vector3("light", foliage.light, 0, kBrightest);
    fields.optional().vector3("shadow", foliage.shadow, 0, 1);
    fields.optional().angle("sun", foliage.sun, 0, 60);
    fields.read("layers", layers, [](const ConfigNode& list) { return list.items(1, kMostLayers); });
    TRY(fields.finish());
    ConfigFaults faults;
    for (const ConfigNode& layer : layers)
        faults.take(readLeaves(layer, foliage), [&](FoliageSource::Layer read) { foliage.layers.push_back(std::move(read)); });
    TRY(faults.result());
    return foliage;
}

Result<glm::vec3> readLight(const ConfigNode& node) { return glm::vec3(TRY(node.vector3(0, kBrightest))); }

template <>
Result<CausticsSource> readAs(const ConfigNode& node) {
    CausticsSource caustics;
    ConfigFields fields(node);
    fields.optional().read("light", caustics.light, readLight);
    fields.optional().vector2("size", caustics.size, kSmallest, kLargest, "m");
    fields.optional().number("depth", caustics.depth, 0, kLargest, "m");
    fields.optional().number("wave_length", caustics.waveLength, kSmallest, kLargest, "m");
    fields.optional().number("wave_height", caustics.waveHeight, 0, kLargest, "m");
    fields.optional().integer("seed", caustics.seed, 0, std::numeric_limits<std::int64_t>::max());
    TRY(fields.finish());
    if (caustics.waveLength < kShortestWave * caustics.size.y)
        return node.error(fmt::format("waves of {} m are too short to be seen on a canvas that is {} m high; at least {} m",
                                      caustics.waveLength, caustics.size.y, kShortestWave * caustics.size.y));
    if (caustics.waveHeight > kSteepestWave * caustics.waveLength)
        return node.error(fmt::format("waves {} m high and {} m long are too steep; at most {} m high", caustics.waveHeight,
                                      caustics.waveLength, kSteepestWave * caustics.waveLength));
    if (caustics.depth * caustics.waveHeight / caustics.waveLength > caustics.size.y)
        return node.error(
            fmt::format("water {} m deep scatters the light all over a canvas that is {} m high; take less of "
                        "'depth' or 'wave_height'",
                        caustics.depth, caustics.size.y));
    return caustics;
}

template <>
Result<MirrorBallSource> readAs(const ConfigNode& node) {
    MirrorBallSource mirrors;
    ConfigFields fields(node);
    fields.optional().read("light", mirrors.light, readLight);
    fields.optional().vector2("size", mirrors.size, kSmallest, kLargest, "m");
    fields.optional().vector3("ball", mirrors.ball, -kLargest, kLargest, "m");
    fields.optional().number("radius", mirrors.radius, kSmallest, kLargest, "m");
    fields.optional().number("facet", mirrors.facet, kSmallest / 10, kLargest, "m");
    fields.optional().vector3("lamp", mirrors.lamp, -kLargest, kLargest, "m");
    fields.optional().number("lamp_radius", mirrors.lampRadius, kSmallest / 10, kLargest, "m");
    fields.optional().number("turn", mirrors.turn, -kLongestTurn, kLongestTurn, "s");
    TRY(fields.finish());
    if (mirrors.ball.z <= mirrors.radius || mirrors.lamp.z <= 0)
        return node.error(
            "the ball and the lamp must be in front of the wall: the third number of 'ball' and 'lamp' says how far");
    if (glm::distance(mirrors.ball, mirrors.lamp) <= mirrors.radius) return node.error("the lamp is inside the ball");
    if (mirrors.facet < kSmallestFacet * mirrors.radius || mirrors.facet > mirrors.radius)
        return node.error(fmt::format("a ball of {} m radius has mirrors of {} m to {} m", mirrors.radius,
                                      kSmallestFacet * mirrors.radius, mirrors.radius));
    if (std::abs(mirrors.turn) < 1) return node.error("a turn takes at least a second");
    return mirrors;
}

Result<fs::path> readVideoFile(const ConfigNode& node) { return readFile(node, "it is a video (MP4, MOV, MKV, WebM)"); }

// A file, or a map with it.
template <>
Result<VideoSource> readAs(const ConfigNode& node) {
    VideoSource video;
    if (!node.isMap()) {
        video.file = TRY(readVideoFile(node));
        return video;
    }
    ConfigFields fields(node);
    std::optional<bool> loops;
    std::size_t atEnd = 0;
    fields.read("file", video.file, readVideoFile);
    fields.optional().time("from", video.from, 0, kLongestVideo);
    fields.optional().read("to", video.to, [](const ConfigNode& value) -> Result<std::optional<Time>> {
        return std::optional(fromSeconds(TRY(value.number(0, kLongestVideo, "s"))));
    });
    fields.optional().read("loop", loops, [](const ConfigNode& value) -> Result<std::optional<bool>> {
        return std::optional(TRY(value.boolean()));
    });
    fields.optional().integer("times", video.times, 1, kMostTimes);
    fields.optional().choice("at_end", atEnd, {"stay", "dark"});
    fields.optional().number("speed", video.speed, kSlowest, kFastest);
    TRY(fields.finish());
    if (video.to && *video.to <= video.from) return node.error("'to' comes after 'from', in seconds of the video");
    if (loops && video.times > 0) return node.error("give one of 'loop' and 'times'");
    if (loops == false) video.times = 1;
    if (atEnd != 0 && video.times == 0) return node.error("this video has no end; add 'times', or remove 'at_end'");
    video.endsDark = atEnd != 0;
    return video;
}

template <>
Result<CameraSource> readAs(const ConfigNode& node) {
    TRY(ConfigFields(node).finish());
    return CameraSource{};
}

// Declares the keys that every lamp has; the caller finishes `fields`.
void declareLamp(ConfigFields& fields, ShadowSource::Lamp& lamp) {
    fields.optional().number("size", lamp.size, 0, kWidestLamp, "m");
    fields.optional().vector3("light", lamp.light, 0, 1);
    fields.optional().vector3("shadow", lamp.shadow, 0, 1);
    fields.optional().list(
        "actors", lamp.actors, [](const ConfigNode& colour) { return colour.vector3(0, 1); }, 1, kMostActors);
}

Result<ShadowSource::Lamp> readLamp(const ConfigNode& node) {
    ShadowSource::Lamp lamp;
    ConfigFields fields(node);
    fields.read("at", lamp.at, [](const ConfigNode& at) -> Result<std::optional<glm::dvec3>> {
        const glm::dvec3 place = TRY(at.vector3(-kLargest, kLargest, "m"));
        return std::optional(place);
    });
    declareLamp(fields, lamp);
    TRY(fields.finish());
    return lamp;
}

Result<glm::dvec2> readSide(const ConfigNode& node) {
    const glm::dvec2 side = TRY(node.vector2(-kLargest, kLargest, "m"));
    if (side.y - side.x < kSmallest) return node.error("[from, to]: the smaller number comes first");
    return side;
}

Result<std::optional<ShadowSource::Picture>> readScreenPart(const ConfigNode& node) {
    ShadowSource::Picture picture;
    ConfigFields fields(node);
    fields.read("x", picture.x, readSide);
    fields.read("y", picture.y, readSide);
    TRY(fields.finish());
    return std::optional(picture);
}

// A file, or a map with it.
template <>
Result<ShadowSource> readAs(const ConfigNode& node) {
    const auto readCastFile = [](const ConfigNode& file) {
        return readFile(file, "make it with 'fantascope pose SILHOUETTE.png' or 'fantascope adapt'");
    };
    ShadowSource shadow;
    ShadowSource::Lamp first;
    if (node.isMap()) {
        ConfigFields fields(node);
        fields.read("cast", shadow.cast, readCastFile);
        declareLamp(fields, first);
        fields.optional().integer("beam", shadow.beam, 1, kMostBeams);
        fields.optional().list("lamps", shadow.lamps, readLamp, 0, kMostLamps - 1);
        fields.optional().integer("samples", shadow.samples, 1, kMostSamples);
        fields.optional().read("play", shadow.play, [](const ConfigNode& play) -> Result<std::optional<ShadowSource::Play>> {
            return std::optional(static_cast<ShadowSource::Play>(TRY(play.choice({"once", "loop", "to_and_fro"}))));
        });
        fields.optional().number("speed", shadow.speed, kSlowest, kFastest);
        fields.optional().read("picture", shadow.picture, readScreenPart);
        TRY(fields.finish());
    } else {
        shadow.cast = TRY(readCastFile(node));
    }
    shadow.lamps.insert(shadow.lamps.begin(), std::move(first));
    return shadow;
}

// Declares the keys of all kinds. `given` counts the keys that the file has.
template <class... Kinds>
void declareKinds(ConfigFields& fields, std::variant<Kinds...>& picture, int& given) {
    const auto declare = [&]<class Kind>(std::type_identity<Kind>) {
        fields.optional().read(Kind::kKey, picture, [&](const ConfigNode& value) -> Result<std::variant<Kinds...>> {
            ++given;
            return std::variant<Kinds...>(TRY(readAs<Kind>(value)));
        });
    };
    (declare(std::type_identity<Kinds>()), ...);
}

// "'a', 'b' or 'c'"
template <class... Kinds>
std::string keysOf(const std::variant<Kinds...>&) {
    std::vector<std::string> keys{fmt::format("'{}'", Kinds::kKey)...};
    const std::string last = std::move(keys.back());
    keys.pop_back();
    return fmt::format("{} or {}", fmt::join(keys, ", "), last);
}

using Files = std::vector<fs::path>;

Files filesIn(const PatternSource& source) { return {source.file}; }
Files filesIn(const SolidSource&) { return {}; }
Files filesIn(const FoliageSource& source) {
    Files files;
    for (const FoliageSource::Layer& layer : source.layers) files.push_back(layer.pattern);
    return files;
}
Files filesIn(const CausticsSource&) { return {}; }
Files filesIn(const MirrorBallSource&) { return {}; }
Files filesIn(const ImageSource& source) { return {source.file}; }
Files filesIn(const VideoSource& source) { return {source.file}; }
Files filesIn(const CameraSource&) { return {}; }
Files filesIn(const ShadowSource& source) { return {source.cast}; }

}  // namespace

Result<Source> readSource(const std::string& name, SourceId id, const ConfigNode& node) {
    Source source{name, id, {}, node.here()};
    int kinds = 0;
    ConfigFields fields(node);
    declareKinds(fields, source.picture, kinds);
    fields.optional().choice("fit", source.fit, {"contain", "cover", "stretch"});
    TRY(fields.finish());
    if (kinds != 1) return node.error(fmt::format("exactly one kind of source is needed: {}", keysOf(source.picture)));
    return source;
}

std::vector<fs::path> filesOf(const Source& source) {
    return std::visit([](const auto& kind) { return filesIn(kind); }, source.picture);
}

}  // namespace fantascope::show
