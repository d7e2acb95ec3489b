#include "show/playback.h"

#include "core/check.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

namespace fantascope::show {

namespace {

constexpr Time kKept = std::chrono::minutes(10);

// The last of `events` that is not after `time`, or null. They are sorted by `at`.
template <class Event>
const Event* lastBy(Time time, const std::vector<Event>& events) {
    const auto next =
        std::upper_bound(events.begin(), events.end(), time, [](Time t, const Event& event) { return t < event.at; });
    return next == events.begin() ? nullptr : &*std::prev(next);
}

using Layers = std::span<const LayerState>;

const LayerState* layerOf(SourceId source, Layers layers) {
    const auto found =
        std::find_if(layers.begin(), layers.end(), [&](const LayerState& layer) { return layer.source == source; });
    return found == layers.end() ? nullptr : &*found;
}

// The layers that add their light one by one.
Layers addedLayers(const OutputState& output) {
    return Layers(output.layers).first(output.pictures.empty() ? output.layers.size() : output.pictures[0].first);
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

bool isOfOneSite(const Look& a, const Look& b) {
    return a.outputs.size() == b.outputs.size() && a.levels.size() == b.levels.size() && a.relays.size() == b.relays.size();
}

// When the next cue follows a cue that was entered at `at`.
std::optional<Time> followerAt(const CueList& list, int cue, Time at) {
    const std::optional<Time>& follow = list.cues[static_cast<std::size_t>(cue)].follow;
    return follow && list.after(cue) ? std::optional(at + *follow) : std::nullopt;
}

// Where a cue of the list `old` is in another list: the cue of the same name, or else the nearest
// previous one that is still there; -1: before the first.
struct FoundCue {
    int cue = -1;
    bool isThere = false;  // the other list has the cue itself
};
FoundCue foundAgain(int cue, const CueList& old, const CueList& list) {
    for (int before = cue; before >= 0; --before) {
        const auto found = std::ranges::find(list.cues, old.cues[static_cast<std::size_t>(before)].name, &CueList::Cue::name);
        if (found != list.cues.end()) return {static_cast<int>(found - list.cues.begin()), before == cue};
    }
    return {-1, cue < 0};
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

Playback::Playback(std::shared_ptr<const CueList> list) : gusts_(list->seed) {
    examine(*list);
    Entry& dark = entries_.emplace_back(Entry{.list = list, .left = {}});
    for (const OutputState& output : list->dark.outputs) dark.outputs.push_back(courseOf(output, output, Time{}, Time{}));
    for (const float level : list->dark.levels) dark.levels.push_back(Course::at(level));
    dark.relays = list->dark.relays;
}

// Checks the looks of another list, and notes how much room they need.
void Playback::examine(const CueList& list) {
    for (const CueList::Cue& cue : list.cues) {
        FANTASCOPE_CHECK(isOfOneSite(cue.look, list.dark), "all looks of a cue list are for one site");
        for (const OutputState& output : cue.look.outputs) {
            for (const LayerState& layer : output.layers) sources_.insert(layer.source);
            composed_.layers += output.pictures.empty() ? 0 : output.layers.size();
            composed_.pictures += output.pictures.size();
        }
    }
    const auto waits = [](const CueList::Cue& cue) { return !cue.follow || *cue.follow > Time{}; };
    FANTASCOPE_CHECK(!list.loops || std::ranges::any_of(list.cues, waits), "a pass of a list that loops takes time");
}

Outcome Playback::apply(const Input& input, std::shared_ptr<const CueList> revision) {
    newest_ = std::max(newest_, input.at);
    const Time at = newest_;
    foresee(at);
    const Entry& now = entryAt(at);
    const int cue = now.cue, last = static_cast<int>(now.list->cues.size()) - 1;
    switch (input.kind) {
        case Input::Kind::Go: {
            if (cue >= 0 && at - now.entered < now.list->goInterval) return Outcome::TooSoonAfterCue;
            const auto next = now.list->after(cue);
            if (!next) return Outcome::AtLastCue;
            enter(*next, at);
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
            if (dark != isDark) shutters_.push_back({at, dark, lightAt(at), now.list->blackoutFade});
            if (dark) trims_.releaseRelays(at);  // a dark picture is no reason for dark streets
            break;
        }
        case Input::Kind::Revise:
            if (const Outcome outcome = revise(std::move(revision), at); outcome != Outcome::Taken) return outcome;
            break;
        case Input::Kind::Correct:
            if (const Outcome outcome = correct(input, *now.list, at); outcome != Outcome::Taken) return outcome;
            break;
        case Input::Kind::Exchange:
            if (const Outcome outcome = exchange(input, *now.list, at); outcome != Outcome::Taken) return outcome;
            break;
        case Input::Kind::Corrections:
            corrections_.push_back(at);
            if (correctsAt(at)) break;
            shifts_.takeBack(at, now.list->shiftSpeed);
            patterns_.takeBack(at, now.list->exchangeFade);
            trims_.want({}, at, now.list->trim.speed);
            break;
        case Input::Kind::Trim:
            if (const Outcome outcome = trim(input.trim, *now.list, at); outcome != Outcome::Taken) return outcome;
            break;
    }
    taken_.push_back(at);
    return Outcome::Taken;
}

Outcome Playback::correct(const Input& input, const CueList& list, Time at) {
    if (input.which < 0 || static_cast<std::size_t>(input.which) >= list.dark.outputs.size()) return Outcome::NoSuchOutput;
    if (!correctsAt(at)) return Outcome::CorrectionsOff;
    if (farthestOf(input.shift) > list.farthestShift) return Outcome::TooFar;
    shifts_.want(static_cast<std::size_t>(input.which), input.shift, at, list.shiftSpeed);
    return Outcome::Taken;
}

Outcome Playback::exchange(const Input& input, const CueList& list, Time at) {
    const SourceId source{static_cast<std::uint32_t>(input.which)};
    if (!correctsAt(at)) return Outcome::CorrectionsOff;
    if (!sources_.contains(source) || !patterns_.exchange(source, input.revision, at, list.exchangeFade))
        return Outcome::NoSuchPattern;
    return Outcome::Taken;
}

Outcome Playback::trim(const LampTrim& trim, const CueList& list, Time at) {
    if (!correctsAt(at)) return Outcome::CorrectionsOff;
    const auto& bounds = list.trim;
    const bool isWithin = trim.share >= bounds.least && trim.share <= 1 && trim.relaysOff >= 0 && trim.relaysOff <= bounds.relays;
    if (!isWithin) return Outcome::TooFar;
    if (trim.relaysOff != trims_.at(at).relaysOff) {
        const Shutter* shutter = lastBy(at, shutters_);
        const bool isHeld = trims_.switched() && at - *trims_.switched() < bounds.relayHold;
        if (isHeld || (shutter && shutter->dark)) return Outcome::RelaysHeld;
    }
    trims_.want(trim, at, bounds.speed);
    return Outcome::Taken;
}

void Playback::enter(int cue, Time at) { put(entered(entryAt(at).list, cue, at)); }

// Adds an entry and the cues that follow it. Later entries are dropped.
void Playback::put(Entry entry) {
    while (entries_.back().at > entry.at) entries_.pop_back();
    entries_.push_back(std::move(entry));
    followOn();
}

// Adds the cues that follow the last entry, at most one pass of the list.
void Playback::followOn() {
    const std::size_t most = cues().cues.size();
    for (std::size_t added = 0; added < most; ++added) {
        const Entry& last = entries_.back();
        if (!last.left) return;
        entries_.push_back(entered(last.list, *last.list->after(last.cue), *last.left));
    }
}

void Playback::foresee(Time time) {
    while (entries_.back().at <= time && entries_.back().left) {
        followOn();
        forget(time - kKept);
    }
}

// Drops what is over before `time`.
void Playback::forget(Time time) {
    const auto next = std::ranges::find_if(entries_, [&](const Entry& entry) { return entry.at > time; });
    if (next - entries_.begin() > 1) entries_.erase(entries_.begin(), next - 1);
}

// The entry of a cue, with the courses from what is seen at `at` to the cue's look.
Playback::Entry Playback::entered(const std::shared_ptr<const CueList>& list, int cue, Time at) const {
    const CueList::Cue& wanted = list->cues[static_cast<std::size_t>(cue)];
    Entry entry{.at = at, .list = list, .cue = cue, .entered = at, .whole = at + wanted.fade, .left = followerAt(*list, cue, at)};
    setOut(entry, wanted.look, wanted.winds, wanted.fade);
    return entry;
}

// Gives an entry the courses to a look. A missing wind is the usual one.
void Playback::setOut(Entry& entry, const Look& look, const std::vector<WindWish>& winds, Time fade) const {
    Look from;
    lookAt(entry.at, from);
    const std::vector<OutputCourse>& before = entryAt(entry.at).outputs;
    for (std::size_t i = 0; i < look.outputs.size(); ++i) {
        entry.outputs.push_back(courseOf(from.outputs[i], look.outputs[i], entry.at, fade));
        entry.outputs.back().wind = WindCourse(before[i].wind, i < winds.size() ? winds[i] : WindWish(), entry.at, fade);
    }
    for (std::size_t i = 0; i < look.levels.size(); ++i) entry.levels.push_back({from.levels[i], look.levels[i], entry.at, fade});
    entry.relays = look.relays;
}

Outcome Playback::revise(std::shared_ptr<const CueList> list, Time at) {
    if (list == nullptr) return Outcome::NoSuchRevision;
    const Entry& now = entryAt(at);
    if (!isOfOneSite(list->dark, now.list->dark)) return Outcome::OtherSite;
    examine(*list);
    const auto [cue, isThere] = foundAgain(now.cue, *now.list, *list);
    Entry entry{.at = at, .list = list, .cue = cue, .entered = now.entered, .whole = now.whole, .left = {}};
    if (!isThere || now.isGone) {
        entry.isGone = true;
        entry.outputs = now.outputs;
        entry.levels = now.levels;
        entry.relays = now.relays;
    } else if (cue < 0) {
        setOut(entry, list->dark, {}, list->blackoutFade);
    } else {
        const CueList::Cue& wanted = list->cues[static_cast<std::size_t>(cue)];
        const Time fade = std::max(now.entered + wanted.fade - at, list->blackoutFade);
        setOut(entry, wanted.look, wanted.winds, fade);
        entry.whole = at + fade;
        entry.left = followerAt(*list, cue, now.entered);
        if (entry.left) entry.left = std::max(at, *entry.left);
    }
    put(std::move(entry));
    return Outcome::Taken;
}

// A source that both pictures have does not begin again.
Playback::OutputCourse Playback::courseOf(const OutputState& from, const OutputState& to, Time at, Time fade) {
    OutputCourse course;
    const auto begunOf = [&](SourceId source) {
        const LayerState* const before = layerOf(source, from.layers);
        return before != nullptr ? before->begun : at;
    };
    const Layers before = addedLayers(from), after = addedLayers(to);
    const auto add = [&](SourceId source) {
        const LayerState *first = layerOf(source, before), *second = layerOf(source, after);
        course.layers.push_back({source, {first ? first->opacity : 0, second ? second->opacity : 0, at, fade}, begunOf(source)});
    };
    for (const LayerState& layer : before) add(layer.source);
    for (const LayerState& layer : after)
        if (!layerOf(layer.source, before)) add(layer.source);

    // The course of a composition; a new one if there is none yet.
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
    return std::max(Time{}, entry.whole - time);
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
    out.shifts.resize(entry.outputs.size());
    for (std::size_t output = 0; output < out.shifts.size(); ++output) out.shifts[output] = shifts_.at(output, time);
    out.lamps = trims_.at(time);
    out.corrects = correctsAt(time);
    for (OutputState& output : out.outputs)
        for (LayerState& layer : output.layers) layer.exchange = patterns_.at(layer.source, time);
    const Shutter* shutter = lastBy(time, shutters_);
    out.blackout = shutter && shutter->dark;
    if (const float light = lightAt(time); light < 1) dim(out, light);
    out.inputs = static_cast<std::uint64_t>(std::upper_bound(taken_.begin(), taken_.end(), time) - taken_.begin());
}

const Playback::Entry& Playback::entryAt(Time time) const {
    const Entry* const entry = lastBy(time, entries_);
    return entry != nullptr ? *entry : entries_.front();
}

// What would be seen without a blackout.
void Playback::lookAt(Time time, Look& out) const {
    const Entry& entry = entryAt(time);
    out.outputs.resize(entry.outputs.size());
    for (std::size_t i = 0; i < entry.outputs.size(); ++i) {
        OutputState& output = out.outputs[i];
        output.layers.reserve(sources_.size() + composed_.layers);
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
    out.relays = entry.relays;
}

bool Playback::correctsAt(Time time) const {
    return (std::upper_bound(corrections_.begin(), corrections_.end(), time) - corrections_.begin()) % 2 == 0;
}

// The factor that a blackout applies to pictures and levels. It moves at a constant rate, so that a
// reversal during the fade makes no step.
float Playback::lightAt(Time time) const {
    const Shutter* shutter = lastBy(time, shutters_);
    if (!shutter) return 1;
    const float moved = Course{0, 1, shutter->at, shutter->fade}.shareAt(time);
    return shutter->dark ? std::max(0.0f, shutter->from - moved) : std::min(1.0f, shutter->from + moved);
}

}  // namespace fantascope::show
