#include "show/site/dmx_merge.h"

#include "allocations.h"
#include "core/random.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <string>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

DmxSlots levels(int first, int second = 0) {
    DmxSlots slots{};
    slots[0] = static_cast<std::uint8_t>(first);
    slots[1] = static_cast<std::uint8_t>(second);
    return slots;
}

// A universe whose own levels are 10 in the first slot and 0 elsewhere.
class Universe {
public:
    explicit Universe(const DmxMerge::Settings& settings = {}) : merge_(settings) {}

    void own(int first, int second = 0) { own_ = asked_ = levels(first, second); }
    void sends(const std::string& sender, const DmxSlots& slots, Time when, int priority = 100, Time silence = 2500ms) {
        merge_.receive({slots, sender, priority, when, silence, false});
    }
    void leaves(const std::string& sender, Time when) { merge_.receive({levels(0), sender, 100, when, 2500ms, true}); }

    // What the show asks of the first slot, and what a trim leaves of it.
    void trimmed(int asked, int left) {
        asked_ = levels(asked);
        own_ = levels(left);
    }
    void claimNothing() { merge_.claimNothing(); }

    // The first two slots.
    std::pair<int, int> at(Time now) {
        DmxSlots out;
        out.fill(99);  // what an earlier frame left
        merge_.mergeAt(now, own_, asked_, out);
        EXPECT_EQ(out[511], 0);
        return {out[0], out[1]};
    }
    // Who is in charge then: "own:100", "desk:150", "desk:150 settling".
    std::vector<std::string> inChargeAt(Time now) {
        at(now);
        std::vector<std::string> names;
        for (const auto& charge : merge_.inCharge())
            names.push_back(fmt::format("{}:{}{}", charge.sender.empty() ? "own" : charge.sender, charge.priority,
                                        charge.settling ? " settling" : ""));
        return names;
    }

private:
    DmxMerge merge_;
    DmxSlots own_ = levels(10), asked_ = levels(10);
};

using Slots = std::pair<int, int>;

TEST(DmxMerge, carries_our_own_levels_while_nobody_else_sends) {
    Universe universe;
    EXPECT_EQ(universe.at(0s), Slots(10, 0));
    EXPECT_THAT(universe.inChargeAt(1h), ElementsAre("own:100"));
}

TEST(DmxMerge, the_highest_priority_wins_whole) {
    Universe universe;
    universe.sends("desk", levels(0, 5), 1s, 150);
    EXPECT_EQ(universe.at(1s), Slots(0, 5)) << "our higher level in the first slot has no say";
    EXPECT_THAT(universe.inChargeAt(1s), ElementsAre("desk:150"));
    universe.sends("phone", levels(7, 7), 2s, 200);
    EXPECT_EQ(universe.at(2s), Slots(7, 7));
}

TEST(DmxMerge, a_lower_priority_has_no_say) {
    Universe universe;
    universe.sends("desk", levels(255, 255), 1s, 99);
    EXPECT_EQ(universe.at(1s), Slots(10, 0));
    EXPECT_THAT(universe.inChargeAt(1s), ElementsAre("own:100"));
}

TEST(DmxMerge, our_own_priority_is_a_setting) {
    Universe low({.ownPriority = 50}), high({.ownPriority = 200});
    for (Universe* const universe : {&low, &high}) universe->sends("desk", levels(3), 1s);
    EXPECT_THAT(low.inChargeAt(1s), ElementsAre("desk:100"));
    EXPECT_THAT(high.inChargeAt(1s), ElementsAre("own:200"));
}

TEST(DmxMerge, among_equals_the_highest_level_of_each_slot_wins) {
    Universe universe;
    universe.sends("a", levels(5, 20), 1s);
    universe.sends("b", levels(30, 15), 1s);
    EXPECT_EQ(universe.at(1s), Slots(30, 20));
    EXPECT_THAT(universe.inChargeAt(1s), ElementsAre("own:100", "a:100", "b:100"));
}

TEST(DmxMerge, by_the_other_rule_the_level_that_changed_last_wins) {
    Universe universe({.rule = DmxMerge::Rule::Latest});
    universe.at(0s);
    universe.sends("a", levels(0, 20), 1s);
    EXPECT_EQ(universe.at(1s), Slots(10, 20)) << "a desk that comes with 0 takes nothing over";
    universe.sends("a", levels(4, 20), 2s);
    EXPECT_EQ(universe.at(2s), Slots(4, 20)) << "later, though lower";
    universe.own(11, 0);
    EXPECT_EQ(universe.at(3s), Slots(11, 20));
    universe.sends("a", levels(4, 20), 4s);
    EXPECT_EQ(universe.at(4s), Slots(11, 20)) << "a repeated frame changes nothing";
}

// The camera trims the show's own lamps, and nobody has moved a fader. Example failure: the desk
// loses the slot that it set, because the trim changes it all the time.
TEST(DmxMerge, by_that_rule_a_trim_takes_no_slot_from_a_desk) {
    Universe universe({.rule = DmxMerge::Rule::Latest});
    universe.own(100);
    universe.at(0s);
    universe.sends("a", levels(50), 1s);
    EXPECT_EQ(universe.at(1s), Slots(50, 0));
    universe.trimmed(100, 80);
    EXPECT_EQ(universe.at(2s), Slots(50, 0));
    universe.trimmed(90, 72);
    EXPECT_EQ(universe.at(3s), Slots(72, 0)) << "the show itself moved it";
    universe.trimmed(90, 60);
    EXPECT_EQ(universe.at(4s), Slots(60, 0)) << "and the trim goes on";
}

// The show ends and fades its lamps: those that a desk moved last are the desk's.
TEST(DmxMerge, by_that_rule_own_levels_that_claim_nothing_take_no_slot_from_a_desk) {
    Universe universe({.rule = DmxMerge::Rule::Latest});
    universe.own(10, 20);
    universe.at(0s);
    universe.sends("a", levels(5, 0), 1s);
    EXPECT_EQ(universe.at(1s), Slots(5, 20));
    universe.claimNothing();
    universe.own(1, 2);
    EXPECT_EQ(universe.at(2s), Slots(5, 2));
    universe.leaves("a", 3s);
    EXPECT_EQ(universe.at(3s), Slots(1, 2));
}

TEST(DmxMerge, by_that_rule_a_desk_that_went_leaves_its_slots_to_the_one_before) {
    Universe universe({.rule = DmxMerge::Rule::Latest});
    universe.at(0s);
    universe.sends("a", levels(20), 1s, 100, 10s);
    universe.sends("b", levels(30), 2s);
    EXPECT_EQ(universe.at(2s), Slots(30, 0));
    universe.leaves("b", 3s);
    EXPECT_EQ(universe.at(3s), Slots(20, 0));
}

TEST(DmxMerge, each_sender_is_gone_after_its_own_silence) {
    Universe universe;
    universe.sends("sacn", levels(30), 1s, 100, 2500ms);
    universe.sends("artnet", levels(20), 1s, 100, 10s);
    EXPECT_EQ(universe.at(3500ms), Slots(30, 0)) << "exactly as long as it may be silent";
    EXPECT_EQ(universe.at(3501ms), Slots(20, 0)) << "an equal one is gone at once: the others were heard all the time";
    EXPECT_EQ(universe.at(11s), Slots(20, 0));
    EXPECT_EQ(universe.at(11001ms), Slots(10, 0));
}

// Example failure: a desk with a loose cable comes and goes every few seconds, and all lamps jump
// between two looks.
TEST(DmxMerge, a_higher_desk_that_fell_silent_holds_while_it_settles) {
    Universe universe({.settling = 1s});
    universe.sends("phone", levels(77), 1s, 120, 10s);
    universe.sends("desk", levels(200), 1s, 150);
    EXPECT_THAT(universe.inChargeAt(3500ms), ElementsAre("desk:150"));
    EXPECT_THAT(universe.inChargeAt(3501ms), ElementsAre("desk:150 settling"));
    EXPECT_EQ(universe.at(4500ms), Slots(200, 0));
    EXPECT_EQ(universe.at(4501ms), Slots(77, 0));
    EXPECT_THAT(universe.inChargeAt(4501ms), ElementsAre("phone:120"));
}

TEST(DmxMerge, a_wiggled_cable_is_not_seen) {
    Universe universe({.settling = 1s});
    for (Time time = 1s; time < 60s; time += 3400ms) {  // it comes back just before its settling is over
        universe.sends("desk", levels(200), time, 150);
        for (Time after = 0ms; after < 3400ms; after += 100ms)
            ASSERT_EQ(universe.at(time + after), Slots(200, 0)) << seconds(time);
    }
}

TEST(DmxMerge, a_termination_acts_at_once) {
    Universe universe({.settling = 1h});
    universe.sends("desk", levels(200), 1s, 150);
    universe.leaves("desk", 2s);
    EXPECT_EQ(universe.at(2s), Slots(10, 0));
    universe.leaves("desk", 2s);  // of somebody who is gone
    universe.sends("desk", levels(30), 3s, 150);
    EXPECT_EQ(universe.at(3s), Slots(30, 0)) << "it may come back";
}

TEST(DmxMerge, a_termination_while_it_settles_acts_at_once_too) {
    Universe universe({.settling = 1h});
    universe.sends("desk", levels(200), 1s, 150);
    EXPECT_THAT(universe.inChargeAt(10s), ElementsAre("desk:150 settling"));
    universe.leaves("desk", 10s);
    EXPECT_EQ(universe.at(10s), Slots(10, 0));
}

TEST(DmxMerge, a_desk_that_lowers_its_priority_gives_way_at_once) {
    Universe universe({.settling = 1h});
    universe.sends("desk", levels(200), 1s, 150);
    universe.at(1s);
    universe.sends("desk", levels(200), 2s, 50);
    EXPECT_EQ(universe.at(2s), Slots(10, 0));
}

TEST(DmxMerge, somebody_higher_does_not_wait_for_a_settling) {
    Universe universe({.settling = 1h});
    universe.sends("desk", levels(200), 1s, 150);
    universe.sends("boss", levels(1), 10s, 200);
    EXPECT_EQ(universe.at(10s), Slots(1, 0));
    universe.sends("twin", levels(2), 10s, 150);
    universe.leaves("boss", 11s);
    EXPECT_EQ(universe.at(11s), Slots(2, 0)) << "of two equals the live one has the say";
}

TEST(DmxMerge, more_senders_than_there_is_room_for_are_not_heard_until_one_goes) {
    Universe universe;
    for (std::size_t i = 0; i < DmxMerge::kMostSenders; ++i) universe.sends(std::to_string(i), levels(20), 1s);
    universe.sends("late", levels(40), 1s, 200);
    EXPECT_EQ(universe.at(1s), Slots(20, 0));
    universe.leaves("3", 1s);
    universe.sends("late", levels(40), 2s, 200);
    EXPECT_EQ(universe.at(2s), Slots(40, 0));
}

TEST(DmxMerge, own_levels_may_lie_where_the_result_goes) {
    DmxMerge merge({});
    DmxSlots slots = levels(10, 3), desk = levels(5, 20);
    merge.receive({desk, "desk", 100, 0s, 1s, false});
    merge.mergeAt(0s, slots, slots, slots);
    EXPECT_EQ(slots, levels(10, 20));
}

// Against the rule written down the slow way: of all who may have a say, slot by slot.
TEST(DmxMerge, random_desks_are_merged_as_the_rule_says) {
    for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
        Rng rng(seed);
        struct Desk {
            DmxSlots slots{};
            int priority = -1;
            Time arrived{};
        };
        std::array<Desk, 5> desks;
        DmxMerge merge({.settling = 0s});
        Time now{};
        for (int step = 0; step < 500; ++step, now += Time(rng.below(1'000'000'000))) {
            const std::size_t who = rng.below(5);
            Desk& desk = desks[who];
            desk = {{}, static_cast<int>(rng.below(3)) + 99, now};
            for (auto& slot : desk.slots) slot = static_cast<std::uint8_t>(rng.below(256));
            const bool ended = rng.below(4) == 0;
            merge.receive({desk.slots, std::to_string(who), desk.priority, now, 2s, ended});
            if (ended) desk.priority = -1;

            const DmxSlots own = levels(128, 1);
            int highest = 100;
            for (const Desk& other : desks)
                if (other.priority >= 0 && now - other.arrived <= 2s) highest = std::max(highest, other.priority);
            DmxSlots wanted = highest == 100 ? own : DmxSlots{};
            for (const Desk& other : desks)
                if (other.priority == highest && now - other.arrived <= 2s)
                    std::transform(wanted.begin(), wanted.end(), other.slots.begin(), wanted.begin(),
                                   [](std::uint8_t a, std::uint8_t b) { return std::max(a, b); });
            DmxSlots got;
            merge.mergeAt(now, own, own, got);
            ASSERT_EQ(got, wanted) << "seed " << seed << ", step " << step;
        }
    }
}

TEST(DmxMerge, allocates_nothing_in_steady_state) {
    const std::string longName = "a desk with a name that no short string holds";
    const DmxSlots slots = levels(3), own = levels(4);
    DmxMerge merge({});
    DmxSlots out;
    merge.receive({slots, longName, 150, 0s, 1s, false});
    merge.mergeAt(0s, own, own, out);
    const std::int64_t before = allocationsSoFar();
    for (int step = 1; step < 1000; ++step) {
        merge.receive({slots, longName, 150, step * 20ms, 1s, false});
        merge.mergeAt(step * 20ms, own, own, out);
    }
    EXPECT_EQ(allocationsSoFar(), before);
}

}  // namespace
}  // namespace fantascope::show
