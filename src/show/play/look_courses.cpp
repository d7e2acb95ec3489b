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

LookCourses::LookCourses(const Look& look) {
    Movement at;
    at.outputs.assign(look.outputs.size(), Fade());
    for (std::size_t output = 0; output < look.outputs.size(); ++output)
        outputs_.push_back(moved(OutputCourse(), look.outputs[output], look.outputs[output], at, output));
    for (const float level : look.levels) levels_.push_back(Course::at(level));
    for (const std::uint8_t relay : look.relays) relays_.push_back({.on = relay});
}

LookCourses LookCourses::moved(const Movement& movement, const CueList::Cue& to) const {
    const Look& look = to.look;
    Look from;
    lookAt(movement.start, {}, from);
    LookCourses after = *this;
    after.moveSpeeds(movement, to);
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        after.outputs_[i] = after.moved(outputs_[i], from.outputs[i], look.outputs[i], movement, i);
        if (const auto& fade = movement.outputs[i])
            after.outputs_[i].wind =
                WindCourse(outputs_[i].wind, i < to.winds.size() ? to.winds[i] : WindWish(), movement.start, fade->longer());
    }
    after.restart(movement);
    for (std::size_t i = 0; i < levels_.size(); ++i)
        if (const auto& fade = movement.levels[i])
            after.levels_[i] = courseOf(from.levels[i], look.levels[i], movement.start, *fade);
    for (std::size_t i = 0; i < relays_.size(); ++i) {
        if (movement.relays[i] != Movement::Relay::Stays) after.relays_[i].on = look.relays[i];
        if (movement.relays[i] == Movement::Relay::Switches) after.relays_[i].since = movement.start;
        if (movement.relays[i] == Movement::Relay::Releases) after.relays_[i].since = Time::min();
    }
    return after;
}

PlayCourse LookCourses::playOf(SourceId source) const {
    const auto found = std::ranges::find(plays_, source, &Play::source);
    return found == plays_.end() ? PlayCourse() : found->course;
}

// A source that nobody sees has its new speed at once.
void LookCourses::moveSpeeds(const Movement& movement, const CueList::Cue& to) {
    if (!movement.speeds) return;
    for (const CueList::Cue::Speed& wish : to.speeds)
        if (std::ranges::find(plays_, wish.source, &Play::source) == plays_.end()) plays_.push_back({wish.source, {}});
    for (auto& [source, course] : plays_) {
        const float speed = to.speedOf(source), now = course.speedAt(movement.start);
        const Time length = speed > now ? movement.speeds->in : movement.speeds->out;
        course = shows(source, movement.start) ? course.moved(speed, movement.start, length, movement.speeds->curve)
                                               : course.at(speed, movement.start);
    }
}

void LookCourses::restart(const Movement& movement) {
    for (const SourceId source : movement.restarts) {
        const Time begun = playOf(source).ownTime(movement.begun);
        const auto again = [&](auto& layers) {
            for (auto& layer : layers)
                if (layer.source == source) layer.begun = begun;
        };
        for (OutputCourse& output : outputs_) {
            again(output.layers);
            for (PictureCourse& picture : output.pictures) again(picture.layers);
        }
    }
}

LookCourses::OutputCourse LookCourses::moved(const OutputCourse& before, const OutputState& from, const OutputState& to,
                                             const Movement& movement, std::size_t output) const {
    OutputCourse after{.layers = {}, .pictures = {}, .wind = before.wind};
    const auto begunOf = [&](SourceId source) {
        const LayerState* const seen = layerOf(source, from.layers);
        return seen != nullptr ? seen->begun : playOf(source).ownTime(movement.begun);
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
    const LookCourses* const self = this;
    lookAt({&self, 1}, time, room, out);
}

void LookCourses::lookAt(std::span<const LookCourses* const> lists, Time time, const Room& room, Look& out) {
    out.outputs.resize(lists.front()->outputs_.size());
    for (std::size_t i = 0; i < out.outputs.size(); ++i) {
        OutputState& output = out.outputs[i];
        output.layers.reserve(room.layers);
        output.pictures.reserve(room.pictures);
        output.layers.clear();
        output.pictures.clear();
        for (const LookCourses* const list : lists) list->addLayers(i, time, output);
        for (const LookCourses* const list : lists) list->addPictures(i, time, output);
    }
    const LookCourses& first = *lists.front();
    out.levels.resize(first.levels_.size());
    std::ranges::transform(first.levels_, out.levels.begin(), [&](const Course& level) { return level.valueAt(time); });
    out.relays.resize(first.relays_.size());
    for (std::size_t i = 0; i < out.levels.size(); ++i)
        for (const LookCourses* const side : lists.subspan(1))
            out.levels[i] = std::max(out.levels[i], side->levels_[i].valueAt(time));
    for (std::size_t i = 0; i < out.relays.size(); ++i) {
        const LookCourses* const last =
            *std::ranges::max_element(lists, {}, [i](const LookCourses* list) { return list->relays_[i].since; });
        out.relays[i] = last->relays_[i].on;
    }
}

bool LookCourses::shows(SourceId source, Time time) const {
    const auto isIt = [&](const auto& layer) { return layer.source == source; };
    return std::ranges::any_of(outputs_, [&](const OutputCourse& output) {
        const auto added = [&](const LayerCourse& layer) { return isIt(layer) && layer.opacity.isSeenFrom(time); };
        const auto composed = [&](const PictureCourse& picture) {
            return picture.share.isSeenFrom(time) && std::ranges::any_of(picture.layers, isIt);
        };
        return std::ranges::any_of(output.layers, added) || std::ranges::any_of(output.pictures, composed);
    });
}

std::optional<Time> LookCourses::whenOver(SourceId source, Time length, Time from) const {
    std::optional<Time> over = Time::min();
    const PlayCourse play = playOf(source);
    const auto waitFor = [&](const auto& layer) {
        if (!over || layer.source != source) return;
        const auto then = play.whenIs(layer.begun + length, from);
        over = then ? std::optional(std::max(*over, *then)) : std::nullopt;
    };
    for (const OutputCourse& output : outputs_) {
        for (const LayerCourse& layer : output.layers)
            if (layer.opacity.to > 0) waitFor(layer);
        for (const PictureCourse& picture : output.pictures)
            if (picture.share.to > 0) std::ranges::for_each(picture.layers, waitFor);
    }
    return over;
}

void LookCourses::addLayers(std::size_t output, Time time, OutputState& out) const {
    const std::size_t ofOthers = out.layers.size();
    for (const LayerCourse& layer : outputs_[output].layers) {
        const float opacity = layer.opacity.valueAt(time);
        if (opacity <= 0) continue;
        const auto end = out.layers.begin() + static_cast<std::ptrdiff_t>(ofOthers);
        const auto same =
            std::find_if(out.layers.begin(), end, [&](const LayerState& other) { return other.source == layer.source; });
        if (same != end) {
            same->opacity = std::max(same->opacity, opacity);
            continue;
        }
        out.layers.push_back({layer.source, opacity, Blend::Add, layer.begun});
        play(time, out.layers.back());
    }
}

void LookCourses::addPictures(std::size_t output, Time time, OutputState& out) const {
    for (const PictureCourse& picture : outputs_[output].pictures) {
        const float share = picture.share.valueAt(time);
        if (share <= 0) continue;
        const auto first = static_cast<std::uint32_t>(out.layers.size());
        for (const LayerState& layer : picture.layers) play(time, out.layers.emplace_back(layer));
        out.pictures.push_back({first, static_cast<std::uint32_t>(out.layers.size()), share});
    }
}

void LookCourses::play(Time time, LayerState& layer) const {
    if (plays_.empty()) return;
    const PlayCourse course = playOf(layer.source);
    layer.behind = course.behindAt(time);
    layer.speed = course.speedAt(time);
}

}  // namespace fantascope::show
