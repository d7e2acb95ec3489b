#include "show/play/look_courses.h"

#include <algorithm>
#include <iterator>
#include <span>

namespace fantascope::show {

namespace {

using Layers = std::span<const LayerState>;

const LayerState* layerOf(SourceId source, Layers layers) {
    const auto found =
        std::find_if(layers.begin(), layers.end(), [&](const LayerState& layer) { return layer.source == source; });
    return found == layers.end() ? nullptr : &*found;
}
float opacityOf(SourceId source, Layers layers) {
    const LayerState* const layer = layerOf(source, layers);
    return layer != nullptr ? layer->opacity : 0;
}

Layers layersOf(const ComposedPicture& picture, const OutputState& output) {
    return Layers(output.layers).subspan(picture.first, picture.last - picture.first);
}

// Whether two pictures have the same composition, whenever their layers began.
bool sameComposition(Layers a, Layers b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const LayerState& one, const LayerState& other) {
        return one.source == other.source && one.opacity == other.opacity && one.blend == other.blend;
    });
}
// The share of a composition in an output's picture.
float shareOf(Layers composition, const OutputState& output) {
    for (const ComposedPicture& picture : output.pictures)
        if (sameComposition(composition, layersOf(picture, output))) return picture.share;
    return 0;
}

Course courseOf(float from, float to, Time start, const Fade& fade) {
    return {from, to, start, to > from ? fade.in : fade.out, fade.curve};
}

// The fade of a layer in a movement; null: it goes on as before.
const Fade* fadeOf(std::size_t output, SourceId source, const Movement& movement) {
    for (const Movement::Layer& layer : movement.layers)
        if (layer.output == output && layer.source == source) return layer.fade ? &*layer.fade : nullptr;
    return movement.outputs[output] ? &*movement.outputs[output] : nullptr;
}

}  // namespace

LookCourses::LookCourses(const Look& look) : relays_(look.relays) {
    Movement at;
    at.outputs.assign(look.outputs.size(), Fade());
    for (std::size_t output = 0; output < look.outputs.size(); ++output)
        outputs_.push_back(moved({}, look.outputs[output], look.outputs[output], at, output));
    for (const float level : look.levels) levels_.push_back(Course::at(level));
}

LookCourses LookCourses::moved(const Movement& movement, const Look& look, std::span<const WindWish> winds) const {
    Look from;
    lookAt(movement.start, {}, from);
    LookCourses after = *this;
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        after.outputs_[i] = moved(outputs_[i], from.outputs[i], look.outputs[i], movement, i);
        if (const auto& fade = movement.outputs[i])
            after.outputs_[i].wind =
                WindCourse(outputs_[i].wind, i < winds.size() ? winds[i] : WindWish(), movement.start, fade->longer());
    }
    for (std::size_t i = 0; i < levels_.size(); ++i)
        if (const auto& fade = movement.levels[i])
            after.levels_[i] = courseOf(from.levels[i], look.levels[i], movement.start, *fade);
    for (std::size_t i = 0; i < relays_.size(); ++i)
        if (movement.relays[i]) after.relays_[i] = look.relays[i];
    return after;
}

LookCourses::OutputCourse LookCourses::moved(const OutputCourse& before, const OutputState& from, const OutputState& to,
                                             const Movement& movement, std::size_t output) {
    OutputCourse after{.layers = {}, .pictures = {}, .wind = before.wind};
    const auto begunOf = [&](SourceId source) {
        const LayerState* const seen = layerOf(source, from.layers);
        return seen != nullptr ? seen->begun : movement.begun;
    };
    const Layers seen = addedLayers(from), wanted = addedLayers(to);
    const auto move = [&](SourceId source, const Fade& fade) {
        const Course opacity = courseOf(opacityOf(source, seen), opacityOf(source, wanted), movement.start, fade);
        after.layers.push_back({source, opacity, begunOf(source)});
    };
    for (const LayerCourse& layer : before.layers)
        if (fadeOf(output, layer.source, movement) == nullptr) after.layers.push_back(layer);
    for (const LayerState& layer : seen)
        if (const Fade* const fade = fadeOf(output, layer.source, movement)) move(layer.source, *fade);
    for (const LayerState& layer : wanted)
        if (const Fade* const fade = fadeOf(output, layer.source, movement); fade != nullptr && !layerOf(layer.source, seen))
            move(layer.source, *fade);

    if (!movement.outputs[output]) {
        after.pictures = before.pictures;
        return after;
    }
    // The picture that comes and the one that goes take the same time. Otherwise both would be seen
    // at full light for a while.
    const Fade& fade = *movement.outputs[output];
    const Time length = to.pictures.empty() ? fade.out : fade.in;
    const auto compose = [&](const ComposedPicture& picture, const OutputState& of) {
        const Layers layers = layersOf(picture, of);
        const auto isThere = [&](const PictureCourse& there) { return sameComposition(there.layers, layers); };
        if (std::ranges::any_of(after.pictures, isThere)) return;
        PictureCourse& added = after.pictures.emplace_back();
        for (const LayerState& layer : layers)
            added.layers.push_back({layer.source, layer.opacity, layer.blend, begunOf(layer.source)});
        added.share = {shareOf(layers, from), shareOf(layers, to), movement.start, length, fade.curve};
    };
    for (const ComposedPicture& picture : from.pictures) compose(picture, from);
    for (const ComposedPicture& picture : to.pictures) compose(picture, to);
    return after;
}

void LookCourses::lookAt(Time time, const Room& room, Look& out) const {
    out.outputs.resize(outputs_.size());
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        OutputState& output = out.outputs[i];
        output.layers.reserve(room.layers);
        output.pictures.reserve(room.pictures);
        output.layers.clear();
        output.pictures.clear();
        for (const LayerCourse& layer : outputs_[i].layers)
            if (const float opacity = layer.opacity.valueAt(time); opacity > 0)
                output.layers.push_back({layer.source, opacity, Blend::Add, layer.begun});
        for (const PictureCourse& picture : outputs_[i].pictures) {
            const float share = picture.share.valueAt(time);
            if (share <= 0) continue;
            const auto first = static_cast<std::uint32_t>(output.layers.size());
            output.layers.insert(output.layers.end(), picture.layers.begin(), picture.layers.end());
            output.pictures.push_back({first, static_cast<std::uint32_t>(output.layers.size()), share});
        }
    }
    out.levels.resize(levels_.size());
    std::ranges::transform(levels_, out.levels.begin(), [&](const Course& level) { return level.valueAt(time); });
    out.relays = relays_;
}

void LookCourses::windsAt(Time time, double lull, std::vector<Wind>& out) const {
    out.resize(outputs_.size());
    std::ranges::transform(outputs_, out.begin(), [&](const OutputCourse& output) { return output.wind.at(time, lull); });
}

}  // namespace fantascope::show
