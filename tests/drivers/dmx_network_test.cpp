// When a universe is sent, and what is kept of received frames: only values and times. tests/peers
// has the networks.

#include "drivers/dmx/dmx_network.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace fantascope::drivers {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

DmxSlots filled(int level) {
    DmxSlots slots;
    slots.fill(static_cast<std::uint8_t>(level));
    return slots;
}

Time tick(int number) { return tickTime(number, DmxNetwork::kRate); }

// The ticks at which a universe is sent, among those at which the network wakes.
std::vector<int> sentTicks(Outgoing& out, int first, int last) {
    std::vector<int> ticks;
    for (int number = first; number <= last; ++number)
        if (out.takeDue(tick(number))) ticks.push_back(number);
    return ticks;
}

class OutgoingUniverse : public testing::Test {
protected:
    Outgoing out_{"universe 1", "test", {}};
};

TEST_F(OutgoingUniverse, says_nothing_before_the_first_levels) {
    EXPECT_THAT(sentTicks(out_, 0, 100), IsEmpty());
    EXPECT_FALSE(out_.nextDue());
}

TEST_F(OutgoingUniverse, repeats_levels_three_times_and_then_every_800_to_1000_ms) {
    out_.setLevels(filled(1));
    // 900 ms are 39.6 ticks.
    EXPECT_THAT(sentTicks(out_, 10, 130), ElementsAre(10, 11, 12, 13, 53, 93));
    for (const auto& [from, to] : {std::pair{13, 53}, {53, 93}}) {
        EXPECT_GE(tick(to) - tick(from), 800ms);
        EXPECT_LE(tick(to) - tick(from), 1000ms);
    }
}

TEST_F(OutgoingUniverse, sends_changing_levels_at_every_tick_and_the_newest_alone) {
    for (int number = 1; number < 100; ++number) {
        out_.setLevels(filled(0));
        out_.setLevels(filled(number));
        ASSERT_TRUE(out_.takeDue(tick(number)));
        ASSERT_EQ(out_.slots, filled(number));
        ASSERT_FALSE(out_.takeDue(tick(number))) << "once a tick";
    }
}

TEST_F(OutgoingUniverse, takes_the_same_levels_for_no_change) {
    std::vector<int> ticks;
    for (int number = 0; number < 60; ++number) {
        out_.setLevels(filled(7));
        if (out_.takeDue(tick(number))) ticks.push_back(number);
    }
    EXPECT_THAT(ticks, ElementsAre(0, 1, 2, 3, 43));
}

// The port closes. Example failure: a lamp that went dark at the last moment stays lit.
TEST_F(OutgoingUniverse, owes_the_newest_levels_and_what_is_left_of_their_repeats) {
    const auto owed = [&] {
        int times = 0;
        while (out_.takePending()) ++times;
        return times;
    };
    EXPECT_EQ(owed(), 0);
    out_.setLevels(filled(1));
    out_.takeDue(tick(1));
    out_.takeDue(tick(2));
    EXPECT_EQ(owed(), 2);
    out_.setLevels(filled(0));
    EXPECT_EQ(owed(), 4);
    EXPECT_EQ(out_.slots, filled(0));
    EXPECT_EQ(owed(), 0);
}

TEST_F(OutgoingUniverse, keeps_to_the_ticks_when_one_is_late) {
    out_.setLevels(filled(1));
    ASSERT_TRUE(out_.takeDue(tick(5) + 20ms)) << "made up for at once";
    EXPECT_EQ(out_.nextDue(), tick(6));
}

TEST_F(OutgoingUniverse, forgets_levels_of_before_a_loss) {
    out_.setLevels(filled(1));
    out_.takeDue(tick(1));
    out_.setLevels(filled(2));
    out_.forget();
    EXPECT_THAT(sentTicks(out_, 2, 100), IsEmpty());
    out_.setLevels(filled(1));
    EXPECT_TRUE(out_.takeDue(tick(101))) << "the same levels as before the loss are new to the line";
}

class IncomingUniverse : public testing::Test {
protected:
    static Incoming::Key key(std::uint32_t number) {
        Incoming::Key key{};
        for (std::size_t i = 0; i < 4; ++i) key[i] = static_cast<std::uint8_t>(number >> (8 * i));
        return key;
    }
    void put(const std::string& source, int level) {
        DmxInput frame;
        frame.slots = filled(level);
        frame.source = source;
        in_.put(std::move(frame));
    }
    Incoming in_{"desk 1", "test", 1};
};

TEST_F(IncomingUniverse, knows_a_sender_for_as_long_as_it_may_be_silent) {
    ASSERT_NE(in_.findOrAdd(key(1), 1s, 2500ms), nullptr);
    in_.findOrAdd(key(1), 1s, 2500ms)->heard = 1s;
    EXPECT_NE(in_.find(key(1), 3500ms, 2500ms), nullptr);
    EXPECT_EQ(in_.find(key(1), 3501ms, 2500ms), nullptr);
    EXPECT_EQ(in_.find(key(2), 1s, 2500ms), nullptr);
}

// Example failure: a broken gateway uses a new name for every packet, and the show runs out of
// memory.
TEST_F(IncomingUniverse, gives_a_flood_of_strangers_a_bounded_place) {
    std::size_t known = 0;
    for (std::uint32_t number = 0; number < 100'000; ++number) {
        DmxSender* const sender = in_.findOrAdd(key(number), 1s, 2500ms);
        if (sender == nullptr) continue;
        sender->heard = 1s;
        ++known;
        put(fmt::format("{}", number), 1);
    }
    EXPECT_EQ(known, Incoming::kMaxSenders);
    EXPECT_NE(in_.findOrAdd(key(100'000), 4s, 2500ms), nullptr) << "those who fell silent make room";
    for (int number = 0; number < 10'000; ++number) put(fmt::format("stranger {}", number), 1);
    std::size_t waiting = 0;
    while (in_.take()) ++waiting;
    EXPECT_LE(waiting, Incoming::kDepth + Incoming::kMaxSenders);
}

}  // namespace
}  // namespace fantascope::drivers
