#include "show/play/playback.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace fantascope::show {

namespace {

constexpr Time kKept = std::chrono::minutes(10);
constexpr Time kLongestAgo = std::chrono::hours(48);  // no night is longer

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

Playback::Playback(std::shared_ptr<const CueList> list) : gusts_(list->seed), player_(std::move(list)) {}

Outcome Playback::apply(const Input& input, std::shared_ptr<const CueList> revision) {
    newest_ = std::max(newest_, input.at);
    const Time at = newest_;
    foresee(at);
    const Outcome outcome = isTooLate(input)         ? Outcome::TooLate
                            : isLockedOut(input, at) ? Outcome::Locked
                                                     : take(input, at, std::move(revision));
    if (outcome == Outcome::Taken) taken_.set(at, taken_.last() + 1);
    return outcome;
}

Outcome Playback::take(const Input& input, Time at, std::shared_ptr<const CueList> revision) {
    const CueList& list = *player_.at(cueTime_.at(at)).list;
    switch (input.kind) {
        case Input::Kind::Go:
        case Input::Kind::Back:
        case Input::Kind::Jump:
        case Input::Kind::Load:
            return moveOn(input, at);
        case Input::Kind::Blackout:
        case Input::Kind::Dark:
        case Input::Kind::Light: {
            const bool isDark = blackout_.wantedAt(at) < 1;
            const bool dark = input.kind == Input::Kind::Blackout ? !isDark || input.late : input.kind == Input::Kind::Dark;
            if (dark != isDark) blackout_.want(dark ? 0 : 1, at, list.blackoutFade);
            if (dark) trims_.releaseRelays(at);  // a dark picture is no reason for dark streets
            return Outcome::Taken;
        }
        case Input::Kind::Pause:
        case Input::Kind::Freeze:
        case Input::Kind::Panic:
        case Input::Kind::Restore:
            return hold(input.kind, at);
        case Input::Kind::Master:
            if (!(input.level >= 0 && input.level <= 1)) return Outcome::NoSuchLevel;
            master_.want(input.level, at, list.blackoutFade);
            return Outcome::Taken;
        case Input::Kind::Revise:
            return revise(std::move(revision), at);
        case Input::Kind::Correct:
            return correct(input, list, at);
        case Input::Kind::Exchange:
            return exchange(input, list, at);
        case Input::Kind::Corrections:
            corrects_.set(at, !corrects_.last());
            if (corrects_.last()) return Outcome::Taken;
            shifts_.takeBack(at, list.shiftSpeed);
            patterns_.takeBack(at, list.exchangeFade);
            trims_.want({}, at, list.trim.speed);
            return Outcome::Taken;
        case Input::Kind::Lock:
            locked_.set(at, !locked_.last());
            return Outcome::Taken;
        case Input::Kind::Trim:
            return trim(input.trim, list, at);
    }
    return Outcome::Taken;
}

// Enters a cue, or says which one GO is to enter.
Outcome Playback::moveOn(const Input& input, Time at) {
    const CuePlayer::Entry& now = player_.at(cueTime_.at(at));
    const CueList& list = *now.list;
    const auto has = [&](int cue) { return cue >= 0 && cue < static_cast<int>(list.cues.size()); };
    if (input.kind == Input::Kind::Load) {
        if (input.cue != kNoCue && !has(input.cue)) return Outcome::NoSuchCue;
        loaded_.set(at, input.cue);
        return Outcome::Taken;
    }
    if (isPanicAt(at)) return Outcome::Panicked;
    std::optional<int> wanted;
    if (input.kind == Input::Kind::Go) {
        if (paused_.last()) {
            letGoOn(at);
            return Outcome::Taken;
        }
        const bool isTooSoon = now.cue >= 0 && cueTime_.at(at) - now.entered < list.goInterval;
        if (isTooSoon || (wentOn_ && at - *wentOn_ < list.goInterval)) return Outcome::TooSoonAfterCue;
        wanted = nextAt(at);
        if (!wanted) return Outcome::AtLastCue;
    } else if (input.kind == Input::Kind::Back) {
        if (now.cue <= 0) return Outcome::AtFirstCue;
        wanted = now.cue - 1;
    } else {
        if ((input.cue != kNoCue && !has(input.cue)) || input.ago < Time{} || input.ago > kLongestAgo) return Outcome::NoSuchCue;
        wanted = input.cue;
    }
    if (paused_.last()) letGoOn(at);
    if (wanted == kNoCue) frozen_.set(at, nullptr);  // a freeze must not keep the light on
    loaded_.set(at, kNoCue);
    player_.enter(*wanted, cueTime_.at(at), input.kind == Input::Kind::Jump ? input.ago : Time{});
    return Outcome::Taken;
}

void Playback::letGoOn(Time at) {
    paused_.set(at, false);
    cueTime_.goOn(at);
    wentOn_ = at;
}

// Holds time or light, or lets them go.
Outcome Playback::hold(Input::Kind kind, Time at) {
    const CuePlayer::Entry& now = player_.at(cueTime_.at(at));
    if (kind == Input::Kind::Restore) {
        if (!isPanicAt(at)) return Outcome::NothingToRestore;
        panic_.want(1, at, now.list->blackoutFade);
        if (!paused_.last()) letGoOn(at);
    } else if (kind == Input::Kind::Panic) {
        panic_.want(0, at, isPanicAt(at) ? Time{} : now.list->panicFade);
        trims_.releaseRelays(at);
        cueTime_.stand(at);
    } else if (isPanicAt(at)) {
        return Outcome::Panicked;
    } else if (kind == Input::Kind::Freeze) {
        frozen_.set(at, frozen_.last() ? nullptr : std::make_shared<const Frozen>(now.seen, cueTime_.at(at)));
    } else if (paused_.last()) {
        letGoOn(at);
    } else {
        paused_.set(at, true);
        cueTime_.stand(at);
    }
    return Outcome::Taken;
}

Outcome Playback::correct(const Input& input, const CueList& list, Time at) {
    if (input.which < 0 || static_cast<std::size_t>(input.which) >= list.dark.outputs.size()) return Outcome::NoSuchOutput;
    if (!corrects_.last()) return Outcome::CorrectionsOff;
    if (farthestOf(input.shift) > list.farthestShift) return Outcome::TooFar;
    shifts_.want(static_cast<std::size_t>(input.which), input.shift, at, list.shiftSpeed);
    return Outcome::Taken;
}

Outcome Playback::exchange(const Input& input, const CueList& list, Time at) {
    const SourceId source{static_cast<std::uint32_t>(input.which)};
    if (!corrects_.last()) return Outcome::CorrectionsOff;
    if (!player_.shows(source) || !patterns_.exchange(source, input.revision, at, list.exchangeFade))
        return Outcome::NoSuchPattern;
    return Outcome::Taken;
}

Outcome Playback::trim(const LampTrim& trim, const CueList& list, Time at) {
    if (!corrects_.last()) return Outcome::CorrectionsOff;
    const auto& bounds = list.trim;
    const bool isWithin = trim.share >= bounds.least && trim.share <= 1 && trim.relaysOff >= 0 && trim.relaysOff <= bounds.relays;
    if (!isWithin) return Outcome::TooFar;
    if (trim.relaysOff != trims_.at(at).relaysOff) {
        const bool isHeld = trims_.switched() && at - *trims_.switched() < bounds.relayHold;
        if (isHeld || blackout_.wantedAt(at) < 1 || isPanicAt(at)) return Outcome::RelaysHeld;
    }
    trims_.want(trim, at, bounds.speed);
    return Outcome::Taken;
}

void Playback::foresee(Time time) {
    const Time kept = time - kKept;
    player_.foresee(cueTime_.at(time), cueTime_.at(kept));
    cueTime_.forget(kept);
    for (Dimmer* const dimmer : {&blackout_, &panic_, &master_}) dimmer->forget(kept);
    for (Steps<bool>* const steps : {&corrects_, &locked_, &paused_}) steps->forget(kept);
    frozen_.forget(kept);
    loaded_.forget(kept);
    taken_.forget(kept);
    shifts_.forget(kept);
    trims_.forget(kept);
}

Outcome Playback::revise(std::shared_ptr<const CueList> list, Time at) {
    if (list == nullptr) return Outcome::NoSuchRevision;
    const CueList& old = *player_.at(cueTime_.at(at)).list;
    if (!isOfOneSite(list->dark, old.dark)) return Outcome::OtherSite;
    if (const int loaded = loaded_.last(); loaded != kNoCue) {
        const FoundCue found = foundAgain(loaded, old, *list);
        loaded_.set(at, found.isThere ? found.cue : kNoCue);
    }
    cueTime_.tick(at);
    player_.revise(std::move(list), cueTime_.at(at));
    return Outcome::Taken;
}

std::optional<int> Playback::nextAt(Time time) const {
    if (const int loaded = loaded_.at(time); loaded != kNoCue) return loaded;
    const CuePlayer::Entry& now = player_.at(cueTime_.at(time));
    return now.list->after(now.cue);
}

void Playback::stateAt(Time time, ShowState& out) const {
    const Time cueTime = cueTime_.at(time);
    const CuePlayer::Entry& entry = player_.at(cueTime);
    const Frozen* const frozen = frozen_.at(time).get();
    out.time = time;
    out.cue = entry.cue;
    out.loaded = loaded_.at(time);
    out.next = nextAt(time);
    out.cueTime = frozen != nullptr ? frozen->cueTime : cueTime;
    out.moves = frozen == nullptr && !cueTime_.standsAt(time);
    const LookCourses& seen = frozen != nullptr ? frozen->seen : entry.seen;
    seen.lookAt(out.cueTime, player_.room(), out);
    seen.windsAt(out.cueTime, gusts_.lullAt(out.cueTime), out.winds);
    out.shifts.resize(out.outputs.size());
    for (std::size_t output = 0; output < out.shifts.size(); ++output) out.shifts[output] = shifts_.at(output, time);
    out.lamps = trims_.at(time);
    out.corrects = corrects_.at(time);
    for (OutputState& output : out.outputs)
        for (LayerState& layer : output.layers) layer.exchange = patterns_.at(layer.source, time);
    out.blackout = blackout_.wantedAt(time) < 1;
    out.panic = isPanicAt(time);
    if (out.panic) out.relays = entry.list->dark.relays;
    out.paused = paused_.at(time);
    out.frozen = frozen != nullptr;
    out.master = master_.wantedAt(time);
    out.locked = locked_.at(time);
    if (const float light = blackout_.at(time) * panic_.at(time) * master_.at(time); light < 1) dim(out, light);
    out.inputs = taken_.at(time);
}

bool Playback::isTooLate(const Input& input) {
    using Kind = Input::Kind;
    constexpr Kind kEvenLate[] = {Kind::Blackout, Kind::Dark,    Kind::Light,    Kind::Panic,
                                  Kind::Revise,   Kind::Correct, Kind::Exchange, Kind::Trim};
    return input.late && std::ranges::find(kEvenLate, input.kind) == std::end(kEvenLate);
}

bool Playback::isLockedOut(const Input& input, Time at) const {
    using Kind = Input::Kind;
    using Source = Input::Source;
    constexpr Kind kSafe[] = {Kind::Blackout, Kind::Dark, Kind::Light, Kind::Panic, Kind::Restore, Kind::Lock};
    const bool isByHand = input.source == Source::Controller || input.source == Source::Contact || input.source == Source::Screen;
    return locked_.at(at) && isByHand && std::ranges::find(kSafe, input.kind) == std::end(kSafe);
}

}  // namespace fantascope::show
