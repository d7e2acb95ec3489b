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

// Whether something that changes at each of `times` in turn, and is off at first, is on.
bool isOnAt(Time time, const std::vector<Time>& times) {
    return (std::upper_bound(times.begin(), times.end(), time) - times.begin()) % 2 == 1;
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
    entries_.push_back({.list = list, .left = {}, .seen = LookCourses(list->dark)});
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
    if (isLockedOut(input, at)) return Outcome::Locked;
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
        case Input::Kind::Lock:
            locks_.push_back(at);
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

void Playback::enter(int cue, Time at) {
    begin(entryAt(at).list, cue, at);
    followOn();
}

// Adds the entries of a cue that is entered at `at`. Later entries are dropped.
void Playback::begin(std::shared_ptr<const CueList> list, int cue, Time at) {
    const CueList::Cue& wanted = list->cues[static_cast<std::size_t>(cue)];
    const std::optional<Time> left = followerAt(*list, cue, at);
    drop(at);
    Entry entry{.at = at,
                .list = std::move(list),
                .cue = cue,
                .entered = at,
                .whole = at + wanted.length(),
                .left = left,
                .seen = entries_.back().seen};
    move(std::move(entry), wanted, Time{});
}

// Adds an entry that goes on with what is seen, and one for each further moment at which the cue
// begins to move something. The cue was entered at `entry.entered`.
void Playback::move(Entry entry, const CueList::Cue& wanted, Time least) {
    entries_.push_back(std::move(entry));
    for (const Movement& movement : wanted.movements(entries_.back().entered, entries_.back().at, least)) {
        if (movement.start > entries_.back().at) {
            Entry later = entries_.back();
            later.at = movement.start;
            entries_.push_back(std::move(later));
        }
        entries_.back().seen = entries_.back().seen.moved(movement, wanted.look, wanted.winds);
    }
}

// Drops what was to come after `at`.
void Playback::drop(Time at) {
    while (entries_.back().at > at) entries_.pop_back();
}

// Adds the cues that follow the last entry, at most one pass of the list.
void Playback::followOn() {
    const std::size_t most = cues().cues.size();
    for (std::size_t added = 0; added < most; ++added) {
        const Entry& last = entries_.back();
        if (!last.left) return;
        begin(last.list, *last.list->after(last.cue), *last.left);
    }
}

void Playback::foresee(Time time) {
    while (entries_.back().entered <= time && entries_.back().left) {
        followOn();
        forget(time - kKept);
    }
}

// Drops what is over before `time`.
void Playback::forget(Time time) {
    const auto next = std::ranges::find_if(entries_, [&](const Entry& entry) { return entry.at > time; });
    if (next - entries_.begin() > 1) entries_.erase(entries_.begin(), next - 1);
}

Outcome Playback::revise(std::shared_ptr<const CueList> list, Time at) {
    if (list == nullptr) return Outcome::NoSuchRevision;
    const Entry& now = entryAt(at);
    if (!isOfOneSite(list->dark, now.list->dark)) return Outcome::OtherSite;
    examine(*list);
    const auto [cue, isThere] = foundAgain(now.cue, *now.list, *list);
    Entry entry{.at = at, .list = list, .cue = cue, .entered = now.entered, .whole = now.whole, .left = {}, .seen = now.seen};
    entry.isGone = !isThere || now.isGone;
    drop(at);
    if (entry.isGone) {
        entries_.push_back(std::move(entry));
    } else if (cue < 0) {
        const CueList::Cue dark{.look = list->dark, .fade = list->blackoutFade, .follow = {}};
        entry.entered = at;
        move(std::move(entry), dark, Time{});
    } else {
        const CueList::Cue& wanted = list->cues[static_cast<std::size_t>(cue)];
        entry.whole = std::max(entry.entered + wanted.length(), at + list->blackoutFade);
        entry.left = followerAt(*list, cue, entry.entered);
        if (entry.left) entry.left = std::max(at, *entry.left);
        move(std::move(entry), wanted, list->blackoutFade);
    }
    followOn();
    return Outcome::Taken;
}

Time Playback::fadeLeftAt(Time time) const {
    const Entry& entry = entryAt(time);
    if (entry.cue < 0) return Time{};
    return std::max(Time{}, entry.whole - time);
}

Time Playback::waitLeftAt(Time time) const {
    const Entry& entry = entryAt(time);
    if (entry.cue < 0 || entry.isGone) return Time{};
    return std::max(Time{}, entry.entered + entry.list->cues[static_cast<std::size_t>(entry.cue)].firstWait() - time);
}

std::optional<Time> Playback::untilFollowAt(Time time) const {
    const Entry& now = entryAt(time);
    const auto next = std::ranges::find_if(entries_, [&](const Entry& entry) { return entry.entered > now.entered; });
    return next != entries_.end() ? std::optional(next->at - time) : std::nullopt;
}

void Playback::stateAt(Time time, ShowState& out) const {
    const Entry& entry = entryAt(time);
    out.time = time;
    out.cue = entry.cue;
    entry.seen.lookAt(time, {sources_.size() + composed_.layers, composed_.pictures}, out);
    entry.seen.windsAt(time, gusts_.lullAt(time), out.winds);
    out.shifts.resize(out.outputs.size());
    for (std::size_t output = 0; output < out.shifts.size(); ++output) out.shifts[output] = shifts_.at(output, time);
    out.lamps = trims_.at(time);
    out.corrects = correctsAt(time);
    for (OutputState& output : out.outputs)
        for (LayerState& layer : output.layers) layer.exchange = patterns_.at(layer.source, time);
    const Shutter* shutter = lastBy(time, shutters_);
    out.blackout = shutter && shutter->dark;
    out.locked = isOnAt(time, locks_);
    if (const float light = lightAt(time); light < 1) dim(out, light);
    out.inputs = static_cast<std::uint64_t>(std::upper_bound(taken_.begin(), taken_.end(), time) - taken_.begin());
}

const Playback::Entry& Playback::entryAt(Time time) const {
    const Entry* const entry = lastBy(time, entries_);
    return entry != nullptr ? *entry : entries_.front();
}

bool Playback::correctsAt(Time time) const { return !isOnAt(time, corrections_); }

bool Playback::isLockedOut(const Input& input, Time at) const {
    using Kind = Input::Kind;
    using Source = Input::Source;
    const bool entersCue = input.kind == Kind::Go || input.kind == Kind::Back || input.kind == Kind::Jump;
    const bool isByHand = input.source == Source::Controller || input.source == Source::Contact || input.source == Source::Screen;
    return entersCue && isByHand && isOnAt(at, locks_);
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
