#include "show/playback.h"

#include "core/check.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

namespace fantascope::show {

namespace {

// The last of `events` that has happened by `time`, or null. They are sorted by `at`.
template <class Event>
const Event* lastBy(Time time, const std::vector<Event>& events) {
    const auto next =
        std::upper_bound(events.begin(), events.end(), time, [](Time t, const Event& event) { return t < event.at; });
    return next == events.begin() ? nullptr : &*std::prev(next);
}

// How much of a change that began at `start` and lasts `length` has happened by `time` >= start, 0..1.
float progress(Time start, Time length, Time time) {
    if (time - start >= length) return 1;
    return static_cast<float>(seconds(time - start) / seconds(length));
}

using Layers = std::span<const LayerState>;

const LayerState* layerOf(std::uint32_t source, Layers layers) {
    const auto found =
        std::find_if(layers.begin(), layers.end(), [&](const LayerState& layer) { return layer.source == source; });
    return found == layers.end() ? nullptr : &*found;
}

// The layers that add as light one by one.
Layers addedLayers(const OutputState& output) {
    return Layers(output.layers).first(output.pictures.empty() ? output.layers.size() : output.pictures[0].first);
}
Layers layersOf(const ComposedPicture& picture, const OutputState& output) {
    return Layers(output.layers).subspan(picture.first, picture.last - picture.first);
}

// Whether two pictures are composed alike, whenever their layers began.
bool sameComposition(Layers a, Layers b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const LayerState& one, const LayerState& other) {
        return one.source == other.source && one.opacity == other.opacity && one.blend == other.blend;
    });
}

// The picture on the way from one to another that began at `entered`: the light of the one goes as that of the other comes. A source goes on
// where both have it. `out` is neither of them.
void mixOutputs(const OutputState& from, const OutputState& to, float share, Time entered, OutputState& out) {
    out.layers.clear();
    out.pictures.clear();
    const auto begunOf = [&](std::uint32_t source) {
        const LayerState* const before = layerOf(source, from.layers);
        return before != nullptr ? before->begun : entered;
    };
    const Layers before = addedLayers(from), after = addedLayers(to);
    const auto add = [&](const LayerState& layer) {
        const LayerState *first = layerOf(layer.source, before), *second = layerOf(layer.source, after);
        const float opacity = std::lerp(first ? first->opacity : 0, second ? second->opacity : 0, share);
        if (opacity > 0) out.layers.push_back({layer.source, opacity, Blend::Add, begunOf(layer.source)});
    };
    for (const LayerState& layer : before) add(layer);
    for (const LayerState& layer : after)
        if (!layerOf(layer.source, before)) add(layer);

    const auto compose = [&](const ComposedPicture& picture, const OutputState& of, float weight) {
        const Layers layers = layersOf(picture, of);
        for (ComposedPicture& there : out.pictures)
            if (sameComposition(layersOf(there, out), layers)) {
                there.share += picture.share * weight;
                return;
            }
        if (picture.share * weight <= 0) return;
        const auto first = static_cast<std::uint32_t>(out.layers.size());
        for (const LayerState& layer : layers)
            out.layers.push_back({layer.source, layer.opacity, layer.blend, begunOf(layer.source)});
        out.pictures.push_back({first, static_cast<std::uint32_t>(out.layers.size()), picture.share * weight});
    };
    for (const ComposedPicture& picture : from.pictures) compose(picture, from, 1 - share);
    for (const ComposedPicture& picture : to.pictures) compose(picture, to, share);
}

// The look on the way from one to another that was entered at `entered`: `share` 0 is `from`, 1 is `to`; the relays are already those of `to`.
void mix(const Look& from, const Look& to, float share, Time entered, Look& out) {
    for (std::size_t i = 0; i < to.outputs.size(); ++i)
        mixOutputs(from.outputs[i], to.outputs[i], share, entered, out.outputs[i]);
    for (std::size_t i = 0; i < to.levels.size(); ++i) out.levels[i] = std::lerp(from.levels[i], to.levels[i], share);
    out.relays = to.relays;
}

void dim(Look& look, float light) {
    for (OutputState& output : look.outputs) {
        if (light == 0) {
            output.layers.clear();
            output.pictures.clear();
        }
        const std::size_t added = addedLayers(output).size();
        for (std::size_t i = 0; i < added; ++i) output.layers[i].opacity *= light;
        for (ComposedPicture& picture : output.pictures) picture.share *= light;
    }
    for (float& level : look.levels) level *= light;
}

}  // namespace

std::string_view nameOf(Outcome outcome) {
    switch (outcome) {
        case Outcome::Taken:
            return "taken";
        case Outcome::TooSoonAfterCue:
            return "ignored: too soon after the cue began";
        case Outcome::AtLastCue:
            return "ignored: this is the last cue";
        case Outcome::AtFirstCue:
            return "ignored: there is no cue before";
        case Outcome::NoSuchCue:
            return "ignored: there is no such cue";
    }
    return "unknown";
}

Playback::Playback(CueList list) : list_(std::move(list)), gusts_(list_.seed) {
    const std::size_t outputs = list_.dark.outputs.size();
    usualWinds_.assign(outputs, WindCourse(WindWish()));
    const auto examine = [&](const Look& look) {
        FANTASCOPE_CHECK(look.outputs.size() == list_.dark.outputs.size() && look.levels.size() == list_.dark.levels.size() &&
                             look.relays.size() == list_.dark.relays.size(),
                         "all looks of a cue list are for one site");
        for (const OutputState& output : look.outputs) {
            for (const LayerState& layer : output.layers) sources_ = std::max<std::size_t>(sources_, layer.source + 1);
            composed_.layers += output.pictures.empty() ? 0 : output.layers.size();
            composed_.pictures += output.pictures.size();
        }
    };
    for (CueList::Cue& cue : list_.cues) {
        examine(cue.look);
        cue.winds.resize(outputs);
    }
}

Outcome Playback::apply(Input input) {
    newest_ = std::max(newest_, input.at);
    const Time at = newest_;
    const int cue = cueAt(at), last = static_cast<int>(list_.cues.size()) - 1;
    switch (input.kind) {
        case Input::Kind::Go: {
            const Entry* entry = lastBy(at, entries_);
            if (entry && at - entry->at < list_.goInterval) return Outcome::TooSoonAfterCue;
            if (cue == last) return Outcome::AtLastCue;
            enter(cue + 1, at);
            break;
        }
        case Input::Kind::Back:
            if (cue <= 0) return Outcome::AtFirstCue;
            enter(cue - 1, at);
            break;
        case Input::Kind::Jump:
            if (input.cue < 0 || input.cue > last) return Outcome::NoSuchCue;
            enter(input.cue, at);
            break;
        case Input::Kind::Blackout:
        case Input::Kind::Dark:
        case Input::Kind::Light: {
            const Shutter* shutter = lastBy(at, shutters_);
            const bool isDark = shutter && shutter->dark;
            const bool dark = input.kind == Input::Kind::Blackout ? !isDark : input.kind == Input::Kind::Dark;
            if (dark != isDark) shutters_.push_back({at, dark, lightAt(at)});
            break;
        }
    }
    taken_.push_back(at);
    return Outcome::Taken;
}

// Enters a cue, and after it those that follow by themselves. What would have followed otherwise is off.
void Playback::enter(int cue, Time at) {
    std::erase_if(entries_, [&](const Entry& entry) { return entry.at > at; });
    for (;;) {
        const CueList::Cue& entered = list_.cues[static_cast<std::size_t>(cue)];
        Look from;
        lookAt(at, from);
        std::vector<WindCourse> winds;
        for (std::size_t i = 0; i < entered.winds.size(); ++i)
            winds.emplace_back(windsAt(at)[i], entered.winds[i], at, entered.fade);
        entries_.push_back({at, cue, std::move(from), std::move(winds)});
        const std::optional<Time> follow = entered.follow;
        if (!follow || static_cast<std::size_t>(cue) + 1 == list_.cues.size()) return;
        at += *follow;
        ++cue;
    }
}

Time Playback::fadeLeftAt(Time time) const {
    const Entry* entry = lastBy(time, entries_);
    return entry ? std::max(Time{}, entry->at + list_.cues[static_cast<std::size_t>(entry->cue)].fade - time) : Time{};
}

std::optional<Time> Playback::untilFollowAt(Time time) const {
    if (entries_.empty() || entries_.back().at <= time) return std::nullopt;
    const auto next =
        std::upper_bound(entries_.begin(), entries_.end(), time, [](Time t, const Entry& entry) { return t < entry.at; });
    return next->at - time;
}

void Playback::stateAt(Time time, ShowState& out) const {
    out.time = time;
    out.cue = cueAt(time);
    lookAt(time, out);
    const std::vector<WindCourse>& winds = windsAt(time);
    const double lull = gusts_.lullAt(time);
    out.winds.resize(winds.size());
    std::transform(winds.begin(), winds.end(), out.winds.begin(), [&](const WindCourse& wind) { return wind.at(time, lull); });
    const Shutter* shutter = lastBy(time, shutters_);
    out.blackout = shutter && shutter->dark;
    if (const float light = lightAt(time); light < 1) dim(out, light);
    out.inputs = static_cast<std::uint64_t>(std::upper_bound(taken_.begin(), taken_.end(), time) - taken_.begin());
}

int Playback::cueAt(Time time) const {
    const Entry* entry = lastBy(time, entries_);
    return entry ? entry->cue : -1;
}

const std::vector<WindCourse>& Playback::windsAt(Time time) const {
    const Entry* entry = lastBy(time, entries_);
    return entry ? entry->winds : usualWinds_;
}

// What is seen, blackout aside.
void Playback::lookAt(Time time, Look& out) const {
    out.outputs.resize(list_.dark.outputs.size());
    for (OutputState& output : out.outputs) {
        output.layers.reserve(sources_ + composed_.layers);
        output.pictures.reserve(composed_.pictures);
    }
    out.levels.resize(list_.dark.levels.size());

    const Entry* entry = lastBy(time, entries_);
    if (!entry) return mix(list_.dark, list_.dark, 1, Time{}, out);
    const CueList::Cue& cue = list_.cues[static_cast<std::size_t>(entry->cue)];
    mix(entry->from, cue.look, progress(entry->at, cue.fade, time), entry->at, out);
}

// The factor of pictures and levels that blackout leaves: it moves at a constant rate, so that a change of mind on the way has no
// step.
float Playback::lightAt(Time time) const {
    const Shutter* shutter = lastBy(time, shutters_);
    if (!shutter) return 1;
    const float moved = progress(shutter->at, list_.blackoutFade, time);
    return shutter->dark ? std::max(0.0f, shutter->from - moved) : std::min(1.0f, shutter->from + moved);
}

}  // namespace fantascope::show
