#pragma once
// A model of the cue engine that shares none of its code.

#include "show/course/lamp_trim.h"
#include "show/course/wind.h"
#include "show/cue_list.h"
#include "show/play/course_models.h"
#include "show/play/input.h"

#include "core/clock.h"
#include "core/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

namespace fantascope::show {

constexpr std::size_t kOutputs = 2, kLevels = 3, kRelays = 2;
constexpr std::uint32_t kSources = 3;
constexpr float kUnseen = 1e-6f;  // an opacity so small may be rounded to 0

// What one thing does in one cue.
struct Move {
    Time wait;
    Fade fade;
    float target;
    bool switches = false;  // it has no fade
    bool tracks = false;    // the cue does not ask for it
};

// Pictures that are composed in order.
inline const std::vector<std::vector<LayerState>> kCompositions = {
    {{{kSources}, 1, Blend::Over}, {{kSources + 1}, 0.5f, Blend::Multiply}},
    {{{kSources + 1}, 1, Blend::Screen}},
};
// Whether a picture of an output is one of them.
inline bool isComposition(std::size_t composition, const OutputState& output, const ComposedPicture& picture) {
    const auto layers = std::span(output.layers).subspan(picture.first, picture.last - picture.first);
    return std::ranges::equal(layers, kCompositions[composition], [](const LayerState& one, const LayerState& other) {
        return one.source == other.source && one.opacity == other.opacity && one.blend == other.blend;
    });
}

// The part of a cue that a thing is in; the cue itself if it is in none.
inline Move moveOf(const CueList::Cue& cue, const std::function<bool(const CueList::Part&)>& isIn, float target) {
    for (const CueList::Part& part : cue.parts)
        if (isIn(part)) return {part.wait, part.fade, target};
    return {cue.wait, cue.fade, target};
}
inline bool has(const std::vector<std::size_t>& things, std::size_t thing) {
    return std::ranges::find(things, thing) != things.end();
}

inline Move moveOfLevel(const CueList::Cue& cue, std::size_t level) {
    return moveOf(
        cue, [&](const CueList::Part& part) { return has(part.levels, level); }, cue.look.levels[level]);
}
inline Move moveOfRelay(const CueList::Cue& cue, std::size_t relay) {
    Move move = moveOf(
        cue, [&](const CueList::Part& part) { return has(part.relays, relay); }, cue.look.relays[relay]);
    move.fade = Fade();
    move.switches = true;
    move.tracks = cue.tracksRelays.size() > relay && cue.tracksRelays[relay] != 0;
    return move;
}
inline Move moveOfLayer(const CueList::Cue& cue, std::size_t output, SourceId source) {
    float target = 0;
    for (const LayerState& layer : cue.look.outputs[output].layers)
        if (layer.source == source) target = layer.opacity;
    const auto alone = [&](const CueList::Part& part) {
        return std::ranges::any_of(part.layers,
                                   [&](const auto& layer) { return layer.output == output && layer.source == source; });
    };
    if (std::ranges::any_of(cue.parts, alone)) return moveOf(cue, alone, target);
    return moveOf(
        cue, [&](const CueList::Part& part) { return has(part.outputs, output); }, target);
}

inline Move moveOfOutput(const CueList::Cue& cue, std::size_t output) {
    return moveOf(
        cue, [&](const CueList::Part& part) { return has(part.outputs, output); }, 0);
}
// Of one of kCompositions: it comes and goes in the time in which a picture comes, or, if none
// does, all goes.
inline Move moveOfPicture(const CueList::Cue& cue, std::size_t output, std::size_t composition) {
    Move move = moveOfOutput(cue, output);
    const OutputState& look = cue.look.outputs[output];
    for (const ComposedPicture& picture : look.pictures)
        if (isComposition(composition, look, picture)) move.target = picture.share;
    const Time length = look.pictures.empty() ? move.fade.out : move.fade.in;
    move.fade = Fade(length, length, move.fade.curve);
    return move;
}

// Finds what is seen by going through everything that happened from the beginning.
class Model {
    // What was entered, and when.
    struct Entered {
        Time at, cueTime;
        Time seen;  // the cue time from which on it is; later than `cueTime` if the cue was joined
        int cue;    // -1: the dark
        const CueList* list;
        std::vector<int> turned{};  // the cues that a follower has followed since an input, each as often
        int follows = 0;            // since an input
        bool isRevised = false;     // it goes on after a revision
        bool isGone = false;        // ... that has lost it: what was seen stays
    };
    // From a moment on, cue time goes on, or stands still.
    struct Run {
        Time at, cueTime;
        bool runs;
    };
    // What the operator has done to single lamps by a moment.
    struct Lamps {
        Time at = Time::min();
        int highlight = -1;
        float level = 1;
        bool solo = false;
        std::map<int, float> parked{};
        std::map<int, float> raised{};
        struct Switched {
            bool on;
            Time since;  // cue time
        };
        std::map<int, Switched> switched{};
    };
    struct Freeze {
        Time at;
        bool on;
        std::vector<std::size_t> entered;  // before it, in each list
    };
    struct Track {
        const CueList* list;
        std::vector<Entered> entered;
        int loaded = -1;
    };

public:
    explicit Model(std::shared_ptr<const CueList> list) : list_(*list), lists_{list} {
        tracks_.push_back({list.get(), {}});
        for (const auto& side : list->sides) tracks_.push_back({side.get(), {}});
    }

    // Until `time`, with the cues that follow by themselves, and with what they bring.
    void advance(Time time) {
        while (const auto follower = followerBy(tracks_[0], cueTime(time))) {
            const int before = tracks_[0].entered.back().cue;
            tracks_[0].entered.push_back(*follower);
            bring(before, {*follower});
        }
        for (Track& track : tracks_) advance(track, cueTime(time));
    }
    bool apply(const Input& input, const std::shared_ptr<const CueList>& revision) {
        newest_ = std::max(newest_, input.at);
        advance(newest_);
        const bool isPanic = panic_.wantedAt(newest_) == 0;
        if (isLocked_ && input.source == Input::Source::Controller) switch (input.kind) {
                case Input::Kind::Blackout:
                case Input::Kind::Dark:
                case Input::Kind::Light:
                case Input::Kind::Panic:
                case Input::Kind::Restore:
                case Input::Kind::Lock:
                    break;
                default:
                    return false;
            }
        switch (input.kind) {
            case Input::Kind::Lock:
                isLocked_ = !isLocked_;
                return true;
            case Input::Kind::Load:
                if (!has(input.list) || input.cue < -1 || input.cue >= count(track(input.list))) return false;
                track(input.list).loaded = input.cue;
                return true;
            case Input::Kind::Go:
            case Input::Kind::Back:
            case Input::Kind::Jump:
                return has(input.list) && !isPanic && moveOn(input, track(input.list));
            case Input::Kind::Pause:
                if (isPanic) return false;
                isPaused_ = !isPaused_;
                run(!isPaused_);
                return true;
            case Input::Kind::Freeze:
                if (isPanic) return false;
                freeze(freezes_.empty() || !freezes_.back().on);
                return true;
            case Input::Kind::Highlight:
            case Input::Kind::Solo:
            case Input::Kind::Level:
            case Input::Kind::Park:
            case Input::Kind::Raise:
            case Input::Kind::Switch:
            case Input::Kind::Release:
                return !isPanic && focus(input);
            case Input::Kind::Revise:
                return revise(revision);
            case Input::Kind::Corrections:
                corrections_.push_back({newest_, !corrects(newest_)});
                if (corrects(newest_)) return true;
                for (auto& shift : shifts_) shift.want({}, newest_, list_.shiftSpeed, farthest);
                for (auto& patterns : patterns_) patterns.takeBack(newest_, list_.exchangeFade);
                trim({1, 0});
                return true;
            case Input::Kind::Correct:
            case Input::Kind::Exchange:
            case Input::Kind::Trim:
                return corrects(newest_) && correct(input, isPanic);
            case Input::Kind::Panic:
                letLampsGo();
                if (relaysOff(newest_) > 0) relaysOff_.push_back({newest_, 0});
                panic_.want(0, newest_, isPanic ? 0s : tracks_[0].list->panicFade);
                run(false);
                return true;
            case Input::Kind::Restore:
                if (!isPanic) return false;
                panic_.want(1, newest_, list_.blackoutFade);
                if (!isPaused_) run(true);
                return true;
            case Input::Kind::Master:
                if (input.level < 0 || input.level > 1) return false;
                master_.want(input.level, newest_, list_.blackoutFade);
                return true;
            default: {
                const bool dark = input.kind == Input::Kind::Dark || (input.kind == Input::Kind::Blackout && !isDark(newest_));
                blackout_.want(dark ? 0 : 1, newest_, list_.blackoutFade);
                if (dark && relaysOff(newest_) > 0) relaysOff_.push_back({newest_, 0});
                return true;
            }
        }
    }

    int cueAt(Time time, std::size_t list) const {
        int cue = -1;
        for (const Entered& entered : tracks_[list].entered)
            if (entered.at <= time) cue = entered.cue;
        return cue;
    }
    bool isDark(Time time) const { return blackout_.wantedAt(time) == 0; }
    bool isPanic(Time time) const { return panic_.wantedAt(time) == 0; }
    bool isFrozen(Time time) const {
        const Freeze* const freeze = freezeAt(time);
        return freeze != nullptr && freeze->on;
    }
    float lightAt(Time time) const { return blackout_.at(time) * panic_.at(time) * master_.at(time); }
    // What GO would enter now; nothing: GO would be ignored as it is the last cue.
    std::optional<int> next(std::size_t list) const {
        const Track& track = tracks_[list];
        if (track.loaded >= 0) return track.loaded;
        const int cue = track.entered.empty() ? -1 : track.entered.back().cue;
        return cue < 0 || hasNext(track, cue) ? std::optional(cue < 0 ? 0 : next(track, cue)) : std::nullopt;
    }
    // The value of a thing in one list, and since when a cue wants it; min(): none does.
    struct Value {
        float value;
        Time since;
    };
    // `moveIn`: what the thing does in a cue.
    Value valueAt(Time time, std::size_t list, float dark, const std::function<Move(const CueList::Cue&)>& moveIn) const {
        const std::vector<Entered>& entered = tracks_[list].entered;
        std::size_t count = entered.size();
        if (isFrozen(time)) {
            count = freezeAt(time)->entered[list];
            time = freezeAt(time)->at;
        }
        Time since = Time::min();
        const Time now = cueTime(time);
        float from = dark, to = dark;
        Time start{};
        Fade fade;
        const auto valueOf = [&](Time at) {
            const Time length = to > from ? fade.in : fade.out;
            const double share = at - start >= length ? 1 : std::max(0., seconds(at - start) / seconds(length));
            const double bent[] = {share, share * share * (3 - 2 * share), share * share, 1 - (1 - share) * (1 - share)};
            return static_cast<float>(from + (to - from) * bent[static_cast<int>(fade.curve)]);
        };
        for (std::size_t i = 0; i < count && entered[i].at <= time; ++i) {
            if (entered[i].isGone) continue;
            const bool isLast = i + 1 == count || entered[i + 1].at > time;
            const Move move = moveIn(cueOf(entered[i]));
            const auto [begins, left] = timed(entered[i], move);
            if (begins > (isLast ? now : entered[i + 1].seen)) continue;
            from = valueOf(begins);
            to = move.target;
            start = begins;
            fade = left;
            if (entered[i].cue < 0)
                since = Time::min();
            else if (!move.tracks)
                since = begins;
        }
        return {valueOf(now), since};
    }
    // The highest of all lists.
    float highestAt(Time time, float dark, const std::function<Move(const CueList::Cue&)>& moveIn) const {
        float most = 0;
        for (std::size_t i = 0; i < tracks_.size(); ++i) most = std::max(most, valueAt(time, i, dark, moveIn).value);
        return most;
    }
    // The sum over all lists.
    float sumAt(Time time, const std::function<Move(const CueList::Cue&)>& moveIn) const {
        float sum = 0;
        for (std::size_t i = 0; i < tracks_.size(); ++i) sum += valueAt(time, i, 0, moveIn).value;
        return sum;
    }
    // Whether a relay is on, and whether that is by hand.
    std::pair<bool, bool> relayAt(Time time, std::size_t relay) const {
        const float dark = list_.dark.relays[relay];
        const auto move = [&](const CueList::Cue& cue) { return moveOfRelay(cue, relay); };
        Value last = valueAt(time, 0, dark, move);
        for (std::size_t side = 1; side < tracks_.size(); ++side)
            if (const auto value = valueAt(time, side, dark, move); value.since > last.since) last = value;
        const auto& switched = lampsAt(time).switched;
        const auto hand = switched.find(static_cast<int>(relay));
        const bool isByHand = hand != switched.end() && hand->second.since > last.since;
        return {isPanic(time) ? dark > 0 : isByHand ? hand->second.on : last.value > 0, isByHand};
    }
    const std::map<int, float>& raisedAt(Time time) const { return lampsAt(time).raised; }
    // The wind of an output, of one list.
    Wind windAt(Time time, std::size_t output, const Gusts& gusts) const {
        const CueList* const main = listAt(time);
        const std::size_t list = output < main->windLists.size() ? main->windLists[output] : 0;
        const std::vector<Entered>& entered = tracks_[list].entered;
        std::size_t count = entered.size();
        if (isFrozen(time)) {
            count = freezeAt(time)->entered[list];
            time = freezeAt(time)->at;
        }
        const Time now = cueTime(time);
        ModelWind wind;
        for (std::size_t i = 0; i < count && entered[i].at <= time; ++i) {
            if (entered[i].isGone) continue;
            const bool isLast = i + 1 == count || entered[i + 1].at > time;
            const CueList::Cue cue = cueOf(entered[i]);
            const Move move = moveOfOutput(cue, output);
            const auto [begins, fade] = timed(entered[i], move);
            if (begins > (isLast ? now : entered[i + 1].seen)) continue;
            wind.want(output < cue.winds.size() ? cue.winds[output] : WindWish(), begins, std::max(fade.in, fade.out));
        }
        return wind.at(now, gusts.lullAt(now));
    }
    bool corrects(Time time) const { return lastOf(corrections_, time, true); }
    int relaysOff(Time time) const { return lastOf(relaysOff_, time, 0); }
    double shareAt(Time time) const { return share_.at(time)[0]; }
    std::array<double, 8> shiftAt(Time time, std::size_t output) const { return shifts_[output].at(time); }
    const ModelPatterns& patternsOf(std::size_t source) const { return patterns_[source]; }
    std::uint64_t revisionAt(Time time) const {
        return static_cast<std::uint64_t>(std::ranges::count_if(revisions_, [&](const auto& each) { return each.at <= time; }));
    }
    // The main list at a time.
    const CueList* listAt(Time time) const {
        const CueList* list = lists_.front().get();
        for (const auto& [at, revised] : revisions_)
            if (at <= time) list = revised;
        return list;
    }
    bool isSolo(Time time) const { return lampsAt(time).solo; }
    float levelAt(Time time, std::size_t level) const {
        const auto lamp = static_cast<int>(level);
        const Lamps& lamps = lampsAt(time);
        if (lamps.highlight == lamp) return lamps.level;
        if (lamps.solo) return 0;
        if (const auto parked = lamps.parked.find(lamp); parked != lamps.parked.end()) return parked->second;
        const auto move = [&](const CueList::Cue& cue) { return moveOfLevel(cue, level); };
        const auto raised = lamps.raised.find(lamp);
        return lightAt(time) * std::max(highestAt(time, 0, move), raised == lamps.raised.end() ? 0 : raised->second);
    }
    Time newest() const { return newest_; }

    // How the sources of a list are played.
    struct Playing {
        struct Layer {
            float from = 0, to = 0;
            Time start{};
            Fade fade{};
            double begun = 0;
            double orBegun = 0;  // if a rounding decides whether it was still seen
            float at(Time time) const {
                const Time length = to > from ? fade.in : fade.out;
                const double share = time - start >= length ? 1 : std::max(0., seconds(time - start) / seconds(length));
                const double bent[] = {share, share * share * (3 - 2 * share), share * share, 1 - (1 - share) * (1 - share)};
                return static_cast<float>(from + (to - from) * bent[static_cast<int>(fade.curve)]);
            }
            bool isSeenFrom(Time time) const { return to != 0 || (from != 0 && time - start < (to > from ? fade.in : fade.out)); }
        };
        std::array<std::array<Layer, kSources>, kOutputs> layers;
        std::array<ModelPlay, kSources> plays;
        Time last{};  // movement
    };
    // At a cue time, after the first `count` cues that were entered.
    Playing playing(const Track& track, std::size_t count, Time now) const {
        Playing playing;
        for (std::size_t i = 0; i < count && track.entered[i].seen <= now; ++i) {
            const bool isLast = i + 1 == count || track.entered[i + 1].seen > now;
            if (!track.entered[i].isGone) play(track.entered[i], isLast ? now : track.entered[i + 1].seen, playing);
        }
        return playing;
    }
    // How much of a source is played on an output, in the first list that shows it; nothing: that
    // is a matter of rounding.
    std::optional<std::pair<double, double>> playedAt(Time time, std::size_t output, std::size_t source) const {
        for (std::size_t list = 0; list < tracks_.size(); ++list) {
            std::size_t count = 0;
            while (count < tracks_[list].entered.size() && tracks_[list].entered[count].at <= time) ++count;
            if (isFrozen(time)) count = freezeAt(time)->entered[list];
            const Time now = cueTime(isFrozen(time) ? freezeAt(time)->at : time);
            const Playing state = playing(tracks_[list], count, now);
            const auto& layer = state.layers[output][source];
            if (layer.at(now) > 0 && layer.at(now) < kUnseen) return std::nullopt;
            const double own = state.plays[source].own(now);
            if (layer.at(now) > 0) return std::pair(own - layer.begun, own - layer.orBegun);
        }
        return std::nullopt;
    }

private:
    bool focus(const Input& input) {
        Lamps lamps = lamps_.back();
        lamps.at = newest_;
        const bool isThere = input.fixture >= 0 && input.fixture < static_cast<int>(kLevels);
        if (input.kind == Input::Kind::Highlight) {
            if (!isThere && input.fixture != -1) return false;
            lamps.highlight = input.fixture;
            lamps.level = 1;
            lamps.solo = lamps.solo && isThere;
        } else if (input.kind == Input::Kind::Park) {
            if (!isThere) return false;
            if (lamps.parked.erase(input.fixture) == 0)
                lamps.parked[input.fixture] = levelAt(newest_, static_cast<std::size_t>(input.fixture));
        } else if (input.kind == Input::Kind::Raise) {
            if (!isThere || input.level < 0 || input.level > 1) return false;
            lamps.raised.erase(input.fixture);
            if (input.level > 0) lamps.raised[input.fixture] = input.level;
        } else if (input.kind == Input::Kind::Switch) {
            if (input.relay < 0 || input.relay >= static_cast<int>(kRelays)) return false;
            lamps.switched[input.relay] = {input.on, cueTime(newest_)};
        } else if (input.kind == Input::Kind::Release) {
            lamps.raised.clear();
            lamps.switched.clear();
        } else {
            if (lamps.highlight < 0) return false;
            if (input.kind == Input::Kind::Solo)
                lamps.solo = !lamps.solo;
            else if (input.level >= 0 && input.level <= 1)
                lamps.level = input.level;
            else
                return false;
        }
        lamps_.push_back(lamps);
        return true;
    }
    // `all`: what only adds to the cues, too.
    void letLampsGo(bool all = false) {
        Lamps lamps{.at = newest_};
        if (!all) lamps.raised = lamps_.back().raised;
        if (!all) lamps.switched = lamps_.back().switched;
        for (const auto& [lamp, level] : lamps_.back().parked)
            if (level == 0) lamps.parked[lamp] = level;
        lamps_.push_back(lamps);
    }
    // When a thing begins to move after a cue was entered, by cue time, and how: what has begun
    // before takes the rest of its time.
    std::pair<Time, Fade> timed(const Entered& entered, const Move& move) const {
        const Time begins = entered.cueTime + move.wait;
        if (begins >= entered.seen || move.switches) return {std::max(begins, entered.seen), move.fade};
        const auto rest = [&](Time length) { return std::max(begins + length - entered.seen, list_.blackoutFade); };
        return {entered.seen, Fade(rest(move.fade.in), rest(move.fade.out), move.fade.curve)};
    }
    bool revise(const std::shared_ptr<const CueList>& list) {
        const auto sameName = [](const auto& one, const auto& other) { return one->name == other->name; };
        if (!list || !std::ranges::equal(list->sides, tracks_[0].list->sides, sameName)) return false;
        if (!runs_.back().runs) runs_.push_back({newest_, runs_.back().cueTime + 1ns, false});
        const Time now = cueTime(newest_);
        for (std::size_t i = 0; i < tracks_.size(); ++i) {
            Track& track = tracks_[i];
            const CueList* const old = std::exchange(track.list, i == 0 ? list.get() : list->sides[i - 1].get());
            const auto found = [&](int cue) {
                const auto& name = old->cues[static_cast<std::size_t>(cue)].name;
                const auto there = std::ranges::find(track.list->cues, name, &CueList::Cue::name);
                return there == track.list->cues.end() ? -1 : static_cast<int>(there - track.list->cues.begin());
            };
            if (track.loaded >= 0) track.loaded = found(track.loaded);
            Entered entered = track.entered.empty() ? Entered{newest_, now, now, -1, track.list} : track.entered.back();
            entered.isRevised = true;
            entered.list = track.list;
            entered.at = newest_;
            entered.seen = now;
            entered.turned.clear();
            entered.follows = 0;
            const int before = entered.cue;
            if (before >= 0) entered.isGone = entered.isGone || found(before) < 0;
            while (entered.cue >= 0 && found(entered.cue) < 0) --entered.cue;
            if (entered.cue >= 0)
                entered.cue = found(entered.cue);
            else if (!entered.isGone)
                entered.cueTime = now;
            track.entered.push_back(entered);
        }
        lists_.push_back(list);
        revisions_.push_back({newest_, list.get()});
        return true;
    }
    bool correct(const Input& input, bool isPanic) {
        if (input.kind == Input::Kind::Trim) {
            const auto& [share, off] = input.trim;
            if (share < list_.trim.least || share > 1 || off < 0 || off > list_.trim.relays) return false;
            const bool isHeld = !relaysOff_.empty() && newest_ - relaysOff_.back().at < list_.trim.relayHold;
            if (off != relaysOff(newest_) && (isHeld || isPanic || isDark(newest_))) return false;
            trim(input.trim);
            return true;
        }
        if (input.kind == Input::Kind::Exchange) {
            const auto source = static_cast<std::uint32_t>(input.which);
            const auto has = [&](const CueList& list) {
                return std::ranges::any_of(list.cues, [&](const CueList::Cue& cue) {
                    return std::ranges::any_of(cue.look.outputs, [&](const OutputState& output) {
                        return std::ranges::find(output.layers, SourceId{source}, &LayerState::source) != output.layers.end();
                    });
                });
            };
            const bool isThere = std::ranges::any_of(lists_, [&](const auto& list) {
                return has(*list) || std::ranges::any_of(list->sides, [&](const auto& side) { return has(*side); });
            });
            return isThere && patterns_[source].exchange(input.revision, newest_, list_.exchangeFade);
        }
        std::array<double, 8> shift{};
        for (std::size_t i = 0; i < shift.size(); ++i) shift[i] = input.shift[i / 2][static_cast<int>(i % 2)];
        if (input.which < 0 || input.which >= static_cast<int>(kOutputs) || farthest({}, shift) > list_.farthestShift)
            return false;
        shifts_[static_cast<std::size_t>(input.which)].want(shift, newest_, list_.shiftSpeed, farthest);
        return true;
    }
    void trim(const LampTrim& trim) {
        share_.want({trim.share}, newest_, list_.trim.speed,
                    [](const auto& from, const auto& to) { return std::abs(to[0] - from[0]); });
        if (trim.relaysOff != relaysOff(newest_)) relaysOff_.push_back({newest_, trim.relaysOff});
    }
    static double farthest(const std::array<double, 8>& from, const std::array<double, 8>& to) {
        double most = 0;
        for (std::size_t i = 0; i < from.size(); i += 2)
            most = std::max(most, std::hypot(to[i] - from[i], to[i + 1] - from[i + 1]));
        return most;
    }
    void freeze(bool on) {
        freezes_.push_back({newest_, on, {}});
        for (const Track& track : tracks_) freezes_.back().entered.push_back(track.entered.size());
    }
    // What a cue does to the sources' layers until a cue time.
    void play(const Entered& entered, Time until, Playing& playing) const {
        const CueList::Cue cue = cueOf(entered);
        const bool isJoined = entered.cueTime < entered.seen && !entered.isRevised;
        const auto timed = [&](Time wait, const Fade& fade) { return this->timed(entered, {wait, fade, 0}); };
        const auto main = timed(cue.wait, cue.fade);
        std::set<Time> starts{main.first};
        for (const CueList::Part& part : cue.parts) starts.insert(timed(part.wait, part.fade).first);
        for (const Time start : starts) {
            if (start > until) break;
            playing.last = start;
            for (std::uint32_t source = 0; source < kSources && start == main.first; ++source) {
                bool isSeen = false;
                for (const auto& output : playing.layers) isSeen = isSeen || output[source].isSeenFrom(start);
                playing.plays[source].change(cue.speedOf({source}), start, isSeen ? main.second : Fade());
            }
            const Time begun = isJoined ? std::min(start, entered.cueTime + cue.wait) : start;
            for (std::size_t output = 0; output < kOutputs; ++output)
                for (std::uint32_t source = 0; source < kSources; ++source) {
                    auto& layer = playing.layers[output][source];
                    const Move move = moveOfLayer(cue, output, {source});
                    const double own = playing.plays[source].own(begun);
                    if (const auto [begins, fade] = timed(move.wait, move.fade); begins == start)
                        layer = {layer.at(start),
                                 move.target,
                                 start,
                                 fade,
                                 layer.at(start) > 0 ? layer.begun : own,
                                 layer.at(start) > kUnseen ? layer.orBegun : own};
                    const bool restarts = std::ranges::find(cue.restarts, SourceId{source}) != cue.restarts.end();
                    if (restarts && start == main.first && entered.cueTime + cue.wait >= entered.seen)
                        layer.begun = layer.orBegun = own;
                }
        }
    }
    // When another cue follows the last one that was entered; nothing: never.
    std::optional<Time> followsAt(const Track& track) const {
        const Entered& last = track.entered.back();
        if (last.cue < 0 || last.isGone) return std::nullopt;
        const CueList::Cue cue = cueOf(last);
        if (!cue.follow || cue.endings.empty() || !usuallyFollowsAt(last)) {
            const auto usually = usuallyFollowsAt(last);
            return usually ? std::optional(std::max(last.seen, *usually)) : std::nullopt;
        }
        const Playing end = playing(track, track.entered.size(), last.seen + 1000s);
        Time over = last.cueTime + cue.length();
        for (const auto& [source, length] : cue.endings)
            for (const auto& output : end.layers) {
                if (output[source.value].to == 0) continue;
                const auto then = end.plays[source.value].whenIs(output[source.value].begun + seconds(length), end.last);
                if (!then) return std::nullopt;
                over = std::max(over, *then);
            }
        return std::max({end.last, last.cueTime + 100ms, over + *cue.follow});
    }
    // The same if its sources come with it.
    static std::optional<Time> usuallyFollowsAt(const Entered& entered) {
        const CueList::Cue cue = cueOf(entered);
        if (entered.cue < 0 || !cue.follow) return std::nullopt;
        if (cue.endings.empty()) return entered.cueTime + *cue.follow;
        Time over = cue.length();
        for (const auto& [source, length] : cue.endings) {
            if (cue.speedOf(source) == 0) return std::nullopt;
            over = std::max(over, cue.wait + Time(std::llround(double(length.count()) / double(cue.speedOf(source)))));
        }
        return entered.cueTime + std::max<Time>(100ms, over + *cue.follow);
    }
    // What follows in a list by a cue time; nothing: nothing does.
    std::optional<Entered> followerBy(const Track& track, Time cueTime) const {
        if (track.entered.empty()) return std::nullopt;
        Entered follower = track.entered.back();
        if (!follow(track, follower, followsAt(track), cueTime)) return std::nullopt;
        follower.seen = follower.cueTime;
        follower.isRevised = false;
        follower.at = runs_.back().at + (follower.cueTime - runs_.back().cueTime);
        return follower;
    }
    void advance(Track& track, Time cueTime) {
        while (const auto follower = followerBy(track, cueTime)) track.entered.push_back(*follower);
    }
    // The main list has gone from cue `before` through others: the sides go with it.
    void bring(int before, const std::vector<Entered>& way) {
        for (std::size_t side = 1; side < tracks_.size(); ++side) {
            std::optional<Entered> wanted;
            int from = before;
            for (const Entered& entered : way) {
                std::optional<int> cue;
                if (entered.cue < 0) cue = -1;
                if (entered.cue >= 0 && from < 0) cue = tracks_[side].list->start;
                if (entered.cue >= 0)
                    for (const auto& with : tracks_[0].list->cues[static_cast<std::size_t>(entered.cue)].with)
                        if (with.list + 1 == side) cue = with.cue;
                if (cue) wanted = Entered{way.back().at, entered.cueTime, way.back().seen, *cue, tracks_[side].list};
                from = entered.cue;
            }
            if (!wanted) continue;
            advance(tracks_[side], wanted->seen);
            while (wanted->cueTime < wanted->seen && follow(tracks_[side], *wanted, usuallyFollowsAt(*wanted), wanted->seen))
                continue;
            tracks_[side].entered.push_back(*wanted);
        }
    }
    bool moveOn(const Input& input, Track& track) {
        std::vector<Entered>& entered = track.entered;
        const int cue = entered.empty() ? -1 : entered.back().cue;
        int wanted = 0;
        switch (input.kind) {
            case Input::Kind::Go:
                if (isPaused_) {
                    isPaused_ = false;
                    run(true);
                    return true;
                }
                if (cue >= 0 && cueTime(newest_) - entered.back().cueTime < list_.goInterval) return false;
                if (wentOn_ && newest_ - *wentOn_ < list_.goInterval) return false;
                if (!next(static_cast<std::size_t>(input.list))) return false;
                wanted = *next(static_cast<std::size_t>(input.list));
                break;
            case Input::Kind::Back:
                if (cue <= 0) return false;
                wanted = cue - 1;
                break;
            default:
                if (input.cue < -1 || input.cue >= count(track) || input.ago < Time{}) return false;
                wanted = input.cue;
        }
        if (isPaused_) run(true);
        isPaused_ = false;
        track.loaded = -1;
        if (wanted < 0 && input.list == 0 && isFrozen(newest_)) freeze(false);
        if (wanted < 0 && input.list == 0) letLampsGo(true);
        const Time now = cueTime(newest_);
        Entered joined{newest_, now - (input.kind == Input::Kind::Jump ? input.ago : Time{}), now, wanted, track.list};
        std::vector<Entered> way{joined};
        while (joined.cueTime < now && follow(track, joined, usuallyFollowsAt(joined), now)) way.push_back(joined);
        entered.push_back(joined);
        if (input.list == 0) bring(cue, way);
        return true;
    }
    // Goes on to the cue that follows `at`, if that is by `cueTime`. Returns whether it is.
    bool follow(const Track& track, Entered& entered, std::optional<Time> at, Time cueTime) const {
        if (!at || *at > cueTime) return false;
        const CueList::Cue cue = cueOf(entered);
        const auto turns = static_cast<int>(std::ranges::count(entered.turned, entered.cue));
        if (!cue.followers.empty() && (cue.times == 0 || turns < cue.times)) {
            const std::uint64_t chance = streamSeed(
                track.list->seed, {static_cast<std::uint64_t>(entered.cue), static_cast<std::uint64_t>(entered.follows)});
            if (cue.times > 0) entered.turned.push_back(entered.cue);
            entered.cue = cue.followers[chance % cue.followers.size()];
        } else {
            if (!hasNext(track, entered.cue)) return false;
            std::erase(entered.turned, entered.cue);
            entered.cue = next(track, entered.cue);
        }
        entered.cueTime = *at;
        ++entered.follows;
        return true;
    }
    void run(bool runs) {
        if (runs_.back().runs == runs) return;
        runs_.push_back({newest_, cueTime(newest_) + (runs ? 1ns : 0ns), runs});  // after all that was seen meanwhile
        if (runs) wentOn_ = newest_;
    }
    Time cueTime(Time time) const {
        const Run* run = &runs_.front();
        for (const Run& candidate : runs_)
            if (candidate.at <= time) run = &candidate;
        return run->runs ? run->cueTime + (time - run->at) : run->cueTime;
    }
    const Lamps& lampsAt(Time time) const {
        const Lamps* lamps = &lamps_.front();
        for (const Lamps& candidate : lamps_)
            if (candidate.at <= time) lamps = &candidate;
        return *lamps;
    }
    const Freeze* freezeAt(Time time) const {
        const Freeze* freeze = nullptr;
        for (const Freeze& candidate : freezes_)
            if (candidate.at <= time) freeze = &candidate;
        return freeze;
    }
    static CueList::Cue cueOf(const Entered& entered) {
        if (entered.cue < 0) return {.look = entered.list->dark, .fade = entered.list->darkFade, .follow = {}};
        return entered.list->cues[static_cast<std::size_t>(entered.cue)];
    }
    static int count(const Track& track) { return static_cast<int>(track.list->cues.size()); }
    static bool hasNext(const Track& track, int cue) { return track.list->loops || cue + 1 < count(track); }
    static int next(const Track& track, int cue) { return (cue + 1) % count(track); }
    bool has(int list) const { return list >= 0 && list < static_cast<int>(tracks_.size()); }
    Track& track(int list) { return tracks_[static_cast<std::size_t>(list)]; }

    // What was set last by a time.
    template <class Value>
    struct Set {
        Time at;
        Value value;
    };
    template <class Value>
    static Value lastOf(const std::vector<Set<Value>>& sets, Time time, Value first) {
        for (const auto& [at, value] : sets)
            if (at <= time) first = value;
        return first;
    }

    const CueList& list_;                                // the first one
    std::vector<std::shared_ptr<const CueList>> lists_;  // all of them
    struct Revision {
        Time at;
        const CueList* list;
    };
    std::vector<Revision> revisions_;
    std::vector<Set<bool>> corrections_;
    std::vector<Set<int>> relaysOff_;
    ModelGlide<1> share_{{1}};
    std::vector<ModelGlide<8>> shifts_{kOutputs, ModelGlide<8>({})};
    std::array<ModelPatterns, kSources + 1> patterns_;
    std::vector<Track> tracks_;  // the main list first
    std::vector<Run> runs_{{Time{}, Time{}, true}};
    std::vector<Freeze> freezes_;
    std::vector<Lamps> lamps_{Lamps()};
    ModelLight blackout_, panic_, master_;
    Time newest_ = Time::min();
    std::optional<Time> wentOn_;
    bool isLocked_ = false, isPaused_ = false;
};

}  // namespace fantascope::show
