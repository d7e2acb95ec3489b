#include "render/source/picture_source.h"

#include "theatre/stage/cast.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace fantascope::render {

namespace {

// The length of what plays of a video, once.
Time partOf(const VideoSource& source) {
    const Time end = source.stream->content().length;
    return std::min(source.to.value_or(end), end) - source.from;
}

}  // namespace

std::optional<Time> positionAt(const VideoSource& source, Time time) {
    // Neither a display's refreshes nor a file's time stamps are exact, so a frame that begins
    // within this time is shown.
    constexpr Time kTolerance = std::chrono::milliseconds(1);
    const Time length = partOf(source);
    const Time played(std::llround(static_cast<double>((time + kTolerance).count()) * source.speed));
    if (source.times > 0 && played < Time{}) return source.from;
    if (source.times == 0 || played / length < source.times) return source.from + (played % length + length) % length;
    return source.endsDark ? std::nullopt : std::optional(source.from + length - Time(1));
}

namespace {

// The length of a motion in frames, there and back if it plays so. Playing to and fro, it
// accelerates and comes to rest within one frame at either end.
double framesOf(const ShadowSource& source) {
    const std::size_t count = source.cast->actors.front().poses.size();
    const auto last = static_cast<double>(count - 1);
    switch (source.play) {
        case ShadowSource::Play::Once:
            break;
        case ShadowSource::Play::Loop:
            return last > 0 ? last + 1 : 0;
        case ShadowSource::Play::ToAndFro:
            return last > 0 ? 2 * (last + 1) : 0;
    }
    return last;
}

}  // namespace

double frameAt(const ShadowSource& source, Time time) {
    const double whole = framesOf(source);
    if (whole <= 0) return 0;
    const double played =
        std::max(0.0, std::chrono::duration<double>(time).count()) * source.speed * source.cast->framesPerSecond;
    if (source.play == ShadowSource::Play::Once) return std::min(played, whole);
    const double frame = std::fmod(played, whole);
    if (source.play == ShadowSource::Play::Loop) return frame;
    const double half = whole / 2, way = std::min(frame, whole - frame), left = half - way;
    return way < 1 ? 0.5 * way * way : left < 1 ? half - 1 - 0.5 * left * left : way - 0.5;
}

Time lengthOf(const ShadowSource& source) {
    const double frames = framesOf(source);
    return frames > 0 ? std::chrono::duration_cast<Time>(
                            std::chrono::duration<double>(frames / (source.cast->framesPerSecond * source.speed)))
                      : Time{};
}

namespace {

double ratio(glm::dvec2 size) { return size.x / size.y; }

std::optional<double> shapeOf(const SolidSource&) { return std::nullopt; }
std::optional<double> shapeOf(const PatternSource& source) { return source.pattern->aspect(); }
std::optional<double> shapeOf(const FoliageSource& source) { return source.layers.front().leaves.pattern->aspect(); }
std::optional<double> shapeOf(const CausticsSource& source) { return ratio(source.size); }
std::optional<double> shapeOf(const MirrorBallSource& source) { return ratio(source.size); }
std::optional<double> shapeOf(const ImageSource& source) {
    return ratio(glm::dvec2(source.picture->width(), source.picture->height()));
}
std::optional<double> shapeOf(const VideoSource& source) { return ratio(source.stream->content().size); }
std::optional<double> shapeOf(const CameraSource& source) { return ratio(source.feed->size()); }
std::optional<double> shapeOf(const ShadowSource& source) { return ratio(source.to - source.from); }

}  // namespace

show::PlayLengths playLengthsOf(const PictureSources& sources) {
    show::PlayLengths lengths;
    for (const auto& [id, source] : sources) {
        const auto* const video = std::get_if<VideoSource>(&source.picture);
        const auto* const shadow = std::get_if<ShadowSource>(&source.picture);
        if (video != nullptr && video->times > 0)
            lengths.add(id, fromSeconds(seconds(partOf(*video)) * video->times / video->speed));
        if (shadow != nullptr && shadow->play == ShadowSource::Play::Once && lengthOf(*shadow) > Time{})
            lengths.add(id, lengthOf(*shadow));
    }
    return lengths;
}

std::optional<double> aspectOf(const PictureSource& source) {
    return std::visit([](const auto& kind) { return shapeOf(kind); }, source.picture);
}

CanvasPart placeOf(const PictureSource& source, double canvasAspect) {
    const auto aspect = aspectOf(source);
    if (!aspect || canvasAspect <= 0) return {};
    return placeOnCanvas(*aspect, canvasAspect, source.fit);
}

}  // namespace fantascope::render
