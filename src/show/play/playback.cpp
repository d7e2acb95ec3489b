#include "show/play/playback.h"

#include "core/check.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
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

Playback::Playback(std::shared_ptr<const CueList> list) : gusts_(list->seed), hand_(*list) {
    FANTASCOPE_CHECK(list->sides.size() <= kMostSides, "a show has only so many lists");
    lists_.push_back({CuePlayer(list)});
    for (const auto& side : list->sides) lists_.push_back({CuePlayer(side)});
}

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
    const CueList& list = *main().at(cueTime_.at(at)).list;
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
        case Input::Kind::Highlight:
        case Input::Kind::Solo:
        case Input::Kind::Level:
        case Input::Kind::Park:
        case Input::Kind::Raise:
        case Input::Kind::Switch:
        case Input::Kind::Release:
            return doByHand(input, list, at);
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
    if (input.list < 0 || static_cast<std::size_t>(input.list) >= lists_.size()) return Outcome::NoSuchList;
    Played& played = lists_[static_cast<std::size_t>(input.list)];
    const CuePlayer::Entry& now = played.player.at(cueTime_.at(at));
    const CueList& list = *now.list;
    const auto has = [&](int cue) { return cue >= 0 && cue < static_cast<int>(list.cues.size()); };
    if (input.kind == Input::Kind::Load) {
        if (input.cue != kNoCue && !has(input.cue)) return Outcome::NoSuchCue;
        played.loaded.set(at, input.cue);
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
        wanted = placeAt(at, played).next;
        if (!wanted) return Outcome::AtLastCue;
    } else if (input.kind == Input::Kind::Back) {
        if (now.cue <= 0) return Outcome::AtFirstCue;
        wanted = now.cue - 1;
    } else {
        if ((input.cue != kNoCue && !has(input.cue)) || input.ago < Time{} || input.ago > kLongestAgo) return Outcome::NoSuchCue;
        wanted = input.cue;
    }
    if (paused_.last()) letGoOn(at);
    if (wanted == kNoCue && input.list == 0) {  // nothing must keep the light on
        frozen_.set(at, nullptr);
        hand_.endAll(at);
    }
    played.loaded.set(at, kNoCue);
    takeBackSides(cueTime_.at(at));
    played.player.enter(*wanted, cueTime_.at(at), input.kind == Input::Kind::Jump ? input.ago : Time{});
    foreseeCues(cueTime_.at(at));
    return Outcome::Taken;
}

void Playback::letGoOn(Time at) {
    paused_.set(at, false);
    cueTime_.goOn(at);
    wentOn_ = at;
}

// Holds time or light, or lets them go.
Outcome Playback::hold(Input::Kind kind, Time at) {
    const CuePlayer::Entry& now = main().at(cueTime_.at(at));
    if (kind == Input::Kind::Restore) {
        if (!isPanicAt(at)) return Outcome::NothingToRestore;
        panic_.want(1, at, now.list->blackoutFade);
        if (!paused_.last()) letGoOn(at);
    } else if (kind == Input::Kind::Panic) {
        hand_.letGo(at);
        panic_.want(0, at, isPanicAt(at) ? Time{} : now.list->panicFade);
        trims_.releaseRelays(at);
        cueTime_.stand(at);
    } else if (isPanicAt(at)) {
        return Outcome::Panicked;
    } else if (kind == Input::Kind::Freeze) {
        freeze(at);
    } else if (paused_.last()) {
        letGoOn(at);
    } else {
        paused_.set(at, true);
        cueTime_.stand(at);
    }
    return Outcome::Taken;
}

Outcome Playback::doByHand(const Input& input, const CueList& list, Time at) {
    if (isPanicAt(at)) return Outcome::Panicked;
    ShowState seen;
    stateAt(at, seen);
    return hand_.apply(input, at, cueTime_.at(at), list, seen);
}

// Keeps what is seen, or shows the cues again.
void Playback::freeze(Time at) {
    if (frozen_.last()) return frozen_.set(at, nullptr);
    Frozen frozen{.seen = {}, .cueTime = cueTime_.at(at)};
    for (const Played& list : lists_) frozen.seen.push_back(list.player.at(frozen.cueTime).seen);
    frozen_.set(at, std::make_shared<const Frozen>(std::move(frozen)));
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
    const auto shows = [&](const Played& list) { return list.player.shows(source); };
    if (std::ranges::none_of(lists_, shows) || !patterns_.exchange(source, input.revision, at, list.exchangeFade))
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
    foreseeCues(cueTime_.at(time));
    for (Played& list : lists_) list.loaded.forget(kept);
    cueTime_.forget(kept);
    for (Dimmer* const dimmer : {&blackout_, &panic_, &master_}) dimmer->forget(kept);
    for (Steps<bool>* const steps : {&corrects_, &locked_, &paused_}) steps->forget(kept);
    frozen_.forget(kept);
    taken_.forget(kept);
    revisions_.forget(kept);
    hand_.forget(kept);
    shifts_.forget(kept);
    trims_.forget(kept);
}

Outcome Playback::revise(std::shared_ptr<const CueList> list, Time at) {
    if (list == nullptr) return Outcome::NoSuchRevision;
    const CueList& old = *main().at(cueTime_.at(at)).list;
    if (!isOfOneSite(list->dark, old.dark)) return Outcome::OtherSite;
    const auto sameName = [](const auto& a, const auto& b) { return a->name == b->name; };
    if (!std::ranges::equal(list->sides, old.sides, sameName)) return Outcome::OtherLists;
    cueTime_.tick(at);
    const Time cueTime = cueTime_.at(at);
    takeBackSides(cueTime);
    for (std::size_t i = 0; i < lists_.size(); ++i) {
        auto& [player, loads] = lists_[i];
        const std::shared_ptr<const CueList>& revised = i == 0 ? list : list->sides[i - 1];
        if (const int loaded = loads.last(); loaded != kNoCue) {
            const FoundCue found = foundAgain(loaded, *player.at(cueTime).list, *revised);
            loads.set(at, found.isThere ? found.cue : kNoCue);
        }
        player.revise(revised, cueTime);
    }
    revisions_.set(at, revisions_.last() + 1);
    return Outcome::Taken;
}

// Works out the follows of all lists, and what the main list brings of the others, until a cue
// time. In steps, since a list forgets.
void Playback::foreseeCues(Time time) {
    const bool hasSides = lists_.size() > 1;
    for (bool isDone = false; !isDone;) {
        const Time step = hasSides ? std::min(time, sidesKnown_ + kKept / 2) : time;
        isDone = step >= time;
        lists_.front().player.foresee(step, step - kKept);
        if (!hasSides) continue;
        brought_ = main().bring(brought_, step, [&](Time at, const CuePlayer::Brought& brought) { bring(at, brought); });
        for (Played& side : std::span(lists_).subspan(1)) side.player.foresee(step, step - kKept);
        sidesKnown_ = std::max(sidesKnown_, step);
    }
}

// Enters a cue of a side list together with one of the main list, at a cue time.
void Playback::bring(Time at, const CuePlayer::Brought& brought) {
    CuePlayer& player = lists_[brought.side + 1].player;
    player.foresee(at, at - kKept);
    player.enterBrought(brought.cue, at, at - brought.entered);
}

// Takes back what the main list was to bring after a cue time.
void Playback::takeBackSides(Time time) {
    if (time >= sidesKnown_) return;
    for (Played& side : std::span(lists_).subspan(1)) side.player.takeBack(time);
    sidesKnown_ = time;
    brought_ = main().at(time).number;
}

ListPlace Playback::placeAt(Time time, const Played& list) const {
    const CuePlayer::Entry& now = list.player.at(cueTime_.at(time));
    const int loaded = list.loaded.at(time);
    return {now.cue, loaded, loaded != kNoCue ? std::optional(loaded) : now.list->after(now.cue)};
}

void Playback::stateAt(Time time, ShowState& out) const {
    const Time cueTime = cueTime_.at(time);
    const CuePlayer::Entry& entry = main().at(cueTime);
    const Frozen* const frozen = frozen_.at(time).get();
    const double lull = gusts_.lullAt(frozen != nullptr ? frozen->cueTime : cueTime);
    out.time = time;
    const ListPlace place = placeAt(time, lists_.front());
    out.cue = place.cue;
    out.loaded = place.loaded;
    out.next = place.next;
    out.sides.resize(lists_.size() - 1);
    for (std::size_t side = 0; side < out.sides.size(); ++side) out.sides[side] = placeAt(time, lists_[side + 1]);
    out.cueTime = frozen != nullptr ? frozen->cueTime : cueTime;
    out.moves = frozen == nullptr && !cueTime_.standsAt(time);
    std::array<const LookCourses*, 2 + kMostSides> seen{};  // the last one is the hand's
    LookCourses::Room room;
    for (std::size_t i = 0; i < lists_.size(); ++i) {
        seen[i] = frozen != nullptr ? &frozen->seen[i] : &lists_[i].player.at(cueTime).seen;
        room.layers += lists_[i].player.room().layers;
        room.pictures += lists_[i].player.room().pictures;
    }
    seen[lists_.size()] = &hand_.listAt(time);
    LookCourses::lookAt(std::span(seen).first(lists_.size() + 1), out.cueTime, room, out);
    out.winds.resize(out.outputs.size());
    const auto& owners = entry.list->windLists;
    for (std::size_t output = 0; output < out.winds.size(); ++output)
        out.winds[output] = seen[output < owners.size() ? owners[output] : 0]->windAt(output, out.cueTime, lull);
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
    const float light = hand_.isSoloAt(time) ? 0 : blackout_.at(time) * panic_.at(time) * master_.at(time);
    if (light < 1) dim(out, light);
    hand_.show(time, *entry.list, std::span(seen).first(lists_.size()), out);
    out.inputs = taken_.at(time);
    out.revision = revisions_.at(time);
}

bool Playback::needs(SourceId source, Time time) const {
    const auto shows = [&](const Played& list) { return list.player.needs(source, cueTime_.at(time)); };
    if (std::ranges::any_of(lists_, shows)) return true;
    const Frozen* const frozen = frozen_.at(time).get();
    return frozen != nullptr &&
           std::ranges::any_of(frozen->seen, [&](const LookCourses& seen) { return seen.shows(source, frozen->cueTime); });
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
