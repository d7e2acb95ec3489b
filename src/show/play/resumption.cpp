#include "show/play/resumption.h"

#include "show/play/playback_replica.h"

#include <algorithm>

namespace fantascope::show {

namespace {

using Kind = Input::Kind;

// What is left of a journal since the last run that did not go on with what was before it.
struct Left {
    std::vector<Journal::Entry> entries;
    std::uint64_t list = 0;
    journal::State last;  // the newest
};
Left leftOf(const Journal& journal) {
    Left left;
    for (const Journal::Entry& entry : journal.entries) {
        if (const auto* const run = std::get_if<journal::Run>(&entry.line)) {
            if (!run->goesOn) left = {};
            left.list = run->list;
        }
        if (const auto* const state = std::get_if<journal::State>(&entry.line)) left.last = *state;
        left.entries.push_back(entry);
    }
    return left;
}

bool belongsToRun(const Input& input) { return input.kind == Kind::Exchange || input.kind == Kind::Revise; }

}  // namespace

std::vector<Input> repairs(const ShowState& now, const journal::State& wanted, Time at) {
    std::vector<Input> inputs;
    const auto add = [&](Kind kind) -> Input& {
        return inputs.emplace_back(Input{.at = at, .kind = kind, .source = Input::Source::Journal});
    };
    const Controls& goal = wanted.controls;
    const bool entersCue = now.cue != goal.cue;
    const std::size_t sides = std::min(goal.sides.size(), now.sides.size());
    bool entersAny = entersCue;
    for (std::size_t side = 0; side < sides; ++side) entersAny = entersAny || now.sides[side].cue != goal.sides[side].cue;
    const bool hasHand = now.raised != goal.raised || now.switched != goal.switched;
    // In a panic no cue is entered, nothing is paused and frozen, and nothing is done by hand.
    const bool lifts =
        now.panic && (!goal.panic || entersAny || hasHand || now.frozen != goal.frozen || now.paused != goal.paused);
    if (lifts) add(Kind::Restore);
    if (entersCue) add(Kind::Jump).cue = goal.cue;
    if ((entersCue ? -1 : now.loaded) != goal.loaded) add(Kind::Load).cue = goal.loaded;
    for (std::size_t side = 0; side < sides; ++side) {
        const auto addTo = [&](Kind kind, int cue) {
            Input& input = add(kind);
            input.cue = cue;
            input.list = static_cast<int>(side) + 1;
        };
        const bool enters = entersCue || now.sides[side].cue != goal.sides[side].cue;  // the main cue may bring others
        if (enters) addTo(Kind::Jump, goal.sides[side].cue);
        if ((enters ? -1 : now.sides[side].loaded) != goal.sides[side].loaded) addTo(Kind::Load, goal.sides[side].loaded);
    }
    const bool isByHand = !goal.raised.empty() || !goal.switched.empty();
    if (hasHand || (entersAny && isByHand)) {
        add(Kind::Release);
        for (const RaisedLamp& lamp : goal.raised) {
            Input& input = add(Kind::Raise);
            input.fixture = lamp.fixture;
            input.level = lamp.level;
        }
        for (const SwitchedRelay& relay : goal.switched) {
            Input& input = add(Kind::Switch);
            input.relay = relay.relay;
            input.on = relay.on;
        }
    }
    if (now.blackout != goal.blackout) add(goal.blackout ? Kind::Dark : Kind::Light);
    if (now.frozen != goal.frozen) add(Kind::Freeze);
    if ((now.paused && !entersAny) != goal.paused) add(Kind::Pause);
    if (now.master != goal.master) add(Kind::Master).level = goal.master;
    if (now.locked != goal.locked) add(Kind::Lock);
    if (now.corrects != wanted.corrects) add(Kind::Corrections);
    if (goal.panic && (!now.panic || lifts)) add(Kind::Panic);
    return inputs;
}

std::optional<Resumption> resume(const Journal& journal, Time at, InputLog& inputs) {
    const Left left = leftOf(journal);
    const std::shared_ptr<const CueList> list = inputs.cues();
    PlaybackReplica replica(inputs);
    ShowState state;
    Resumption resumption{.at = at, .isExact = left.list == hashOf(*list)};
    const auto repair = [&](const journal::State& wanted, Time when) {
        replica.stateAt(when, state);
        for (const Input& input : repairs(state, wanted, when)) inputs.submit(input);
    };
    if (resumption.isExact) {
        bool isLost = false;  // something is, and no state has told since what it has led to
        for (const Journal::Entry& entry : left.entries) {
            isLost = isLost || entry.isAfterDamage || std::holds_alternative<journal::Gap>(entry.line);
            if (const auto* const input = std::get_if<Input>(&entry.line); input != nullptr && !belongsToRun(*input))
                inputs.submit(*input);
            const auto* const told = std::get_if<journal::State>(&entry.line);
            if (!std::exchange(isLost, isLost && told == nullptr) || told == nullptr) continue;
            repair(*told, told->at);
        }
    } else {
        journal::State wanted = left.last;
        const auto found = std::ranges::find(list->cues, wanted.cue, &CueList::Cue::name);
        wanted.controls.cue =
            found == list->cues.end() || wanted.controls.cue < 0 ? -1 : static_cast<int>(found - list->cues.begin());
        wanted.controls.loaded = -1;
        wanted.controls.sides.clear();  // the main cue brings them
        wanted.controls.raised.clear();
        wanted.controls.switched.clear();
        repair(wanted, at);
    }
    if (inputs.reader().next() == nullptr) return std::nullopt;
    inputs.foresee(at);
    replica.stateAt(at, state);
    resumption.cue = state.cue;
    return resumption;
}

}  // namespace fantascope::show
