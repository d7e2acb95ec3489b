#include "show/play/hand_controls.h"

#include <algorithm>
#include <utility>

namespace fantascope::show {

namespace {

std::span<float> levelsOf(int fixture, const CueList& list, Look& look) {
    const auto [first, count] = list.fixtures[static_cast<std::size_t>(fixture)];
    return std::span(look.levels).subspan(first, count);
}

// Puts a value in its place, by one of its members.
template <class Value, class Key>
void put(std::vector<Value>& values, Key key, const Value& value) {
    const auto place = std::ranges::lower_bound(values, value.*key, {}, key);
    if (place != values.end() && (*place).*key == value.*key)
        *place = value;
    else
        values.insert(place, value);
}

bool isLevel(float level) { return level >= 0 && level <= 1; }

}  // namespace

HandControls::HandControls(const CueList& list)
    : idle_(std::make_shared<const Hand>(Hand{.list = LookCourses(list.dark)})), hand_(idle_) {}

bool HandControls::takes(Input::Kind kind) {
    using Kind = Input::Kind;
    constexpr Kind kKinds[] = {Kind::Highlight, Kind::Solo, Kind::Level, Kind::Park, Kind::Raise, Kind::Switch, Kind::Release};
    return std::ranges::find(kKinds, kind) != std::end(kKinds);
}

Outcome HandControls::apply(const Input& input, Time at, Time cueTime, const CueList& list, const Look& seen) {
    const auto has = [&](int fixture) { return fixture >= 0 && fixture < static_cast<int>(list.fixtures.size()); };
    switch (input.kind) {
        case Input::Kind::Highlight:
            return has(input.fixture) || input.fixture == -1 ? focus(input, at) : Outcome::NoSuchFixture;
        case Input::Kind::Park:
            return has(input.fixture) ? park(input.fixture, at, list, seen) : Outcome::NoSuchFixture;
        case Input::Kind::Raise:
            return has(input.fixture) ? raise(input, at, list) : Outcome::NoSuchFixture;
        case Input::Kind::Switch:
            if (input.relay < 0 || input.relay >= static_cast<int>(seen.relays.size())) return Outcome::NoSuchRelay;
            switchRelay(input, at, cueTime);
            return Outcome::Taken;
        case Input::Kind::Release:
            hand_.set(at, idle_);
            return Outcome::Taken;
        default:
            return focus(input, at);
    }
}

// Shows a lamp, or it alone, for who focuses it.
Outcome HandControls::focus(const Input& input, Time at) {
    if (input.kind == Input::Kind::Highlight) {
        highlight_.set(at, input.fixture);
        highlightLevel_.set(at, 1);
        if (input.fixture < 0) solo_.set(at, false);
    } else if (highlight_.last() < 0) {
        return Outcome::NoSuchFixture;
    } else if (input.kind == Input::Kind::Solo) {
        solo_.set(at, !solo_.last());
    } else if (isLevel(input.level)) {
        highlightLevel_.set(at, input.level);
    } else {
        return Outcome::NoSuchLevel;
    }
    return Outcome::Taken;
}

Outcome HandControls::park(int fixture, Time at, const CueList& list, const Look& seen) {
    std::vector<Parked> parked = parked_.last();
    if (std::erase_if(parked, [&](const Parked& each) { return each.fixture == fixture; }) == 0) {
        const auto [first, count] = list.fixtures[static_cast<std::size_t>(fixture)];
        const auto levels = std::span(seen.levels).subspan(first, count);
        put(parked, &Parked::fixture, {fixture, {levels.begin(), levels.end()}});
    }
    parked_.set(at, std::move(parked));
    return Outcome::Taken;
}

Outcome HandControls::raise(const Input& input, Time at, const CueList& list) {
    if (!isLevel(input.level)) return Outcome::NoSuchLevel;
    Hand hand = *hand_.last();
    std::erase_if(hand.raised, [&](const RaisedLamp& lamp) { return lamp.fixture == input.fixture; });
    if (input.level > 0) put(hand.raised, &RaisedLamp::fixture, {input.fixture, input.level});
    const auto [first, count] = list.fixtures[static_cast<std::size_t>(input.fixture)];
    for (std::size_t level = first; level < first + count; ++level) hand.list.setLevel(level, input.level);
    hand_.set(at, std::make_shared<const Hand>(std::move(hand)));
    return Outcome::Taken;
}

void HandControls::switchRelay(const Input& input, Time at, Time cueTime) {
    Hand hand = *hand_.last();
    put(hand.switched, &SwitchedRelay::relay, {input.relay, input.on});
    hand.list.setRelay(static_cast<std::size_t>(input.relay), input.on, cueTime);
    hand_.set(at, std::make_shared<const Hand>(std::move(hand)));
}

void HandControls::letGo(Time at) {
    highlight_.set(at, -1);
    solo_.set(at, false);
    std::vector<Parked> parked = parked_.last();
    const auto isLit = [](float level) { return level > 0; };
    std::erase_if(parked, [&](const Parked& each) { return std::ranges::any_of(each.levels, isLit); });
    parked_.set(at, std::move(parked));
}

void HandControls::endAll(Time at) {
    letGo(at);
    hand_.set(at, idle_);
}

void HandControls::forget(Time time) {
    hand_.forget(time);
    solo_.forget(time);
    highlight_.forget(time);
    highlightLevel_.forget(time);
    parked_.forget(time);
}

void HandControls::show(Time time, const CueList& list, std::span<const LookCourses* const> cues, ShowState& out) const {
    const Hand& hand = *hand_.at(time);
    out.raised = hand.raised;
    out.switched.clear();
    for (const SwitchedRelay& each : hand.switched) {
        const auto relay = static_cast<std::size_t>(each.relay);
        const auto isBefore = [&](const LookCourses* cue) { return cue->switchedAt(relay) < hand.list.switchedAt(relay); };
        if (std::ranges::all_of(cues, isBefore)) out.switched.push_back(each);
    }
    out.solo = solo_.at(time);
    out.parked.clear();
    for (const auto& [fixture, levels] : parked_.at(time)) {
        out.parked.push_back(fixture);
        if (!out.solo) std::ranges::copy(levels, levelsOf(fixture, list, out).begin());
    }
    out.highlight = highlight_.at(time);
    out.highlightLevel = highlightLevel_.at(time);
    if (out.highlight >= 0) std::ranges::fill(levelsOf(out.highlight, list, out), out.highlightLevel);
}

}  // namespace fantascope::show
