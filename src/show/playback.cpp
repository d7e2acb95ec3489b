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

Playback::Playback(CueList list) : list_(std::move(list)), gusts_(list_.seed) {
    const std::size_t outputs = list_.dark.outputs.size();
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
    const auto waits = [](const CueList::Cue& cue) { return !cue.follow || *cue.follow > Time{}; };
    FANTASCOPE_CHECK(!list_.loops || std::ranges::any_of(list_.cues, waits), "a pass of a list that loops takes time");
    Entry& dark = entries_.emplace_back();
    for (const OutputState& output : list_.dark.outputs) dark.outputs.push_back(courseOf(output, output, Time{}, Time{}));
    for (const float level : list_.dark.levels) dark.levels.push_back(Course::at(level));
}

Outcome Playback::apply(Input input) {
    newest_ = std::max(newest_, input.at);
    const Time at = newest_;
    foresee(at);
    const int cue = cueAt(at), last = static_cast<int>(list_.cues.size()) - 1;
    switch (input.kind) {
        case Input::Kind::Go: {
            if (cue >= 0 && at - entryAt(at).at < list_.goInterval) return Outcome::TooSoonAfterCue;
            if (cue == last && !list_.loops) return Outcome::AtLastCue;
            enter((cue + 1) % (last + 1), at);
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

// Enters a cue, and after it those that follow by themselves. What would have followed otherwise is
// off.
void Playback::enter(int cue, Time at) {
    while (entries_.back().at > at) entries_.pop_back();
    entries_.push_back(entered(cue, at));
    followOn(list_.cues.size());
}

std::optional<int> Playback::followerOf(int cue) const {
    if (cue < 0 || !list_.cues[static_cast<std::size_t>(cue)].follow) return std::nullopt;
    const int next = cue + 1, count = static_cast<int>(list_.cues.size());
    if (next < count) return next;
    return list_.loops ? std::optional(0) : std::nullopt;
}

// Adds the cues that follow by themselves after the last entry, at most so many.
void Playback::followOn(std::size_t most) {
    for (std::size_t added = 0; added < most; ++added) {
        const Entry& last = entries_.back();
        const std::optional<int> next = followerOf(last.cue);
        if (!next) return;
        entries_.push_back(entered(*next, last.at + *list_.cues[static_cast<std::size_t>(last.cue)].follow));
    }
}

void Playback::foresee(Time time) {
    while (entries_.back().at <= time && followerOf(entries_.back().cue)) followOn(list_.cues.size());
}

// The courses from what is seen at `at` to a cue's look.
Playback::Entry Playback::entered(int cue, Time at) const {
    const CueList::Cue& wanted = list_.cues[static_cast<std::size_t>(cue)];
    Look from;
    lookAt(at, from);
    Entry entry{at, cue, {}, {}};
    const std::vector<OutputCourse>& before = entryAt(at).outputs;
    for (std::size_t i = 0; i < wanted.look.outputs.size(); ++i) {
        entry.outputs.push_back(courseOf(from.outputs[i], wanted.look.outputs[i], at, wanted.fade));
        entry.outputs.back().wind = WindCourse(before[i].wind, wanted.winds[i], at, wanted.fade);
    }
    for (std::size_t i = 0; i < wanted.look.levels.size(); ++i)
        entry.levels.push_back({from.levels[i], wanted.look.levels[i], at, wanted.fade});
    return entry;
}

// A source goes on where both pictures have it.
Playback::OutputCourse Playback::courseOf(const OutputState& from, const OutputState& to, Time at, Time fade) {
    OutputCourse course;
    const auto begunOf = [&](std::uint32_t source) {
        const LayerState* const before = layerOf(source, from.layers);
        return before != nullptr ? before->begun : at;
    };
    const Layers before = addedLayers(from), after = addedLayers(to);
    const auto add = [&](std::uint32_t source) {
        const LayerState *first = layerOf(source, before), *second = layerOf(source, after);
        course.layers.push_back({source, {first ? first->opacity : 0, second ? second->opacity : 0, at, fade}, begunOf(source)});
    };
    for (const LayerState& layer : before) add(layer.source);
    for (const LayerState& layer : after)
        if (!layerOf(layer.source, before)) add(layer.source);

    // The course of a composition; a new one where none is alike.
    const auto composed = [&](const ComposedPicture& picture, const OutputState& of) -> PictureCourse& {
        const Layers layers = layersOf(picture, of);
        for (PictureCourse& there : course.pictures)
            if (sameComposition(there.layers, layers)) return there;
        PictureCourse& added = course.pictures.emplace_back();
        for (const LayerState& layer : layers)
            added.layers.push_back({layer.source, layer.opacity, layer.blend, begunOf(layer.source)});
        return added;
    };
    for (const ComposedPicture& picture : from.pictures) composed(picture, from).leaving = {picture.share, 0, at, fade};
    for (const ComposedPicture& picture : to.pictures) composed(picture, to).coming = {0, picture.share, at, fade};
    return course;
}

Time Playback::fadeLeftAt(Time time) const {
    const Entry& entry = entryAt(time);
    if (entry.cue < 0) return Time{};
    return std::max(Time{}, entry.at + list_.cues[static_cast<std::size_t>(entry.cue)].fade - time);
}

std::optional<Time> Playback::untilFollowAt(Time time) const {
    const Entry* const next = &entryAt(time) + 1;
    if (next == entries_.data() + entries_.size()) return std::nullopt;
    return next->at - time;
}

void Playback::stateAt(Time time, ShowState& out) const {
    const Entry& entry = entryAt(time);
    out.time = time;
    out.cue = entry.cue;
    lookAt(time, out);
    const double lull = gusts_.lullAt(time);
    out.winds.resize(entry.outputs.size());
    std::transform(entry.outputs.begin(), entry.outputs.end(), out.winds.begin(),
                   [&](const OutputCourse& output) { return output.wind.at(time, lull); });
    const Shutter* shutter = lastBy(time, shutters_);
    out.blackout = shutter && shutter->dark;
    if (const float light = lightAt(time); light < 1) dim(out, light);
    out.inputs = static_cast<std::uint64_t>(std::upper_bound(taken_.begin(), taken_.end(), time) - taken_.begin());
}

const Playback::Entry& Playback::entryAt(Time time) const { return *lastBy(time, entries_); }

// What is seen, blackout aside.
void Playback::lookAt(Time time, Look& out) const {
    const Entry& entry = entryAt(time);
    out.outputs.resize(entry.outputs.size());
    for (std::size_t i = 0; i < entry.outputs.size(); ++i) {
        OutputState& output = out.outputs[i];
        output.layers.reserve(sources_ + composed_.layers);
        output.pictures.reserve(composed_.pictures);
        output.layers.clear();
        output.pictures.clear();
        for (const LayerCourse& layer : entry.outputs[i].layers)
            if (const float opacity = layer.opacity.valueAt(time); opacity > 0)
                output.layers.push_back({layer.source, opacity, Blend::Add, layer.begun});
        for (const PictureCourse& picture : entry.outputs[i].pictures) {
            const float share = picture.leaving.valueAt(time) + picture.coming.valueAt(time);
            if (share <= 0) continue;
            const auto first = static_cast<std::uint32_t>(output.layers.size());
            output.layers.insert(output.layers.end(), picture.layers.begin(), picture.layers.end());
            output.pictures.push_back({first, static_cast<std::uint32_t>(output.layers.size()), share});
        }
    }
    out.levels.resize(entry.levels.size());
    std::ranges::transform(entry.levels, out.levels.begin(), [&](const Course& level) { return level.valueAt(time); });
    out.relays = entry.cue < 0 ? list_.dark.relays : list_.cues[static_cast<std::size_t>(entry.cue)].look.relays;
}

// The factor of pictures and levels that blackout leaves: it moves at a constant rate, so that a
// change of mind on the way has no step.
float Playback::lightAt(Time time) const {
    const Shutter* shutter = lastBy(time, shutters_);
    if (!shutter) return 1;
    const float moved = Course{0, 1, shutter->at, list_.blackoutFade}.shareAt(time);
    return shutter->dark ? std::max(0.0f, shutter->from - moved) : std::min(1.0f, shutter->from + moved);
}

}  // namespace fantascope::show
