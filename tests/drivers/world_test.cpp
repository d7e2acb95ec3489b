#include "drivers/site/world.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <thread>

namespace fantascope::site {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

class WorldTest : public testing::Test {
protected:
    std::vector<std::string> takenFromDesk(int universe) {
        std::vector<std::string> frames;
        while (const auto frame = world_.takeFromDesk(universe))
            frames.push_back(frame->source + std::to_string(frame->slots[0]));
        return frames;
    }
    void send(const std::string& source, std::uint8_t level) {
        DmxInput frame;
        frame.source = source;
        frame.slots[0] = level;
        world_.sendFromDesk(1, frame);
    }
    std::shared_ptr<const CameraFrame> cameraFrame(std::uint64_t sequence) {
        return std::make_shared<CameraFrame>(CameraFrame{RgbaImage(1, 1), clock_.now(), sequence});
    }

    ManualClock clock_;
    World world_{clock_};
    std::array<std::uint8_t, kDmxSlots> bright_ = [] {
        std::array<std::uint8_t, kDmxSlots> slots;
        slots.fill(255);
        return slots;
    }();
};

TEST_F(WorldTest, everything_is_plugged_in_and_dark_at_first) {
    EXPECT_TRUE(world_.plugged("universe 1"));
    EXPECT_THAT(world_.slots(1), testing::Each(0));
    EXPECT_THAT(world_.relays("road"), IsEmpty());
    EXPECT_FALSE(world_.contact("doors", 0));
    EXPECT_EQ(world_.frame("left"), nullptr);
    EXPECT_EQ(world_.takeFromDesk(1), std::nullopt);
    EXPECT_EQ(world_.takePress(), std::nullopt);
    EXPECT_EQ(world_.takeFromCamera(), nullptr);
}

TEST_F(WorldTest, a_plug_counts_each_time_it_is_really_pulled) {
    world_.setPlugged("camera", true);
    EXPECT_EQ(world_.losses("camera"), 0);
    world_.setPlugged("camera", false);
    world_.setPlugged("camera", false);
    EXPECT_FALSE(world_.plugged("camera"));
    EXPECT_EQ(world_.losses("camera"), 1);
    world_.setPlugged("camera", true);
    EXPECT_TRUE(world_.plugged("camera"));
    EXPECT_EQ(world_.losses("camera"), 1);
}

// Most dimmers hold their last level when the line falls silent.
TEST_F(WorldTest, lamps_hold_their_levels_while_their_own_line_is_unplugged) {
    EXPECT_TRUE(world_.setSlots(1, bright_));
    world_.setPlugged("universe 1", false);
    EXPECT_FALSE(world_.setSlots(1, std::array<std::uint8_t, kDmxSlots>{}));
    EXPECT_TRUE(world_.setSlots(2, bright_));
    EXPECT_EQ(world_.slots(1), bright_);
    EXPECT_EQ(world_.slots(2), bright_);
}

TEST_F(WorldTest, relays_are_safe_when_installed_and_when_their_plug_is_pulled) {
    world_.installRelays("road", {true, false});
    EXPECT_THAT(world_.relays("road"), ElementsAre(true, false));
    EXPECT_TRUE(world_.setRelays("road", {false, true}));
    EXPECT_THAT(world_.relays("road"), ElementsAre(false, true));
    world_.setPlugged("road", false);
    EXPECT_THAT(world_.relays("road"), ElementsAre(true, false));
    EXPECT_FALSE(world_.setRelays("road", {false, true}));
    world_.setPlugged("road", true);
    EXPECT_THAT(world_.relays("road"), ElementsAre(true, false));
}

// Example failure: every switch by hand is a loss, and a person who tries the lamps in turn causes
// a dozen messages.
TEST_F(WorldTest, a_hand_at_the_relays_is_a_loss_where_they_were_as_written) {
    world_.installRelays("road", {true, false});
    world_.installRelays("park", {true});
    world_.switchRelaysByHand("road", {true, true});
    EXPECT_EQ(world_.losses("road"), 0) << "nobody had written them";
    EXPECT_TRUE(world_.setRelays("road", {false, true}));
    EXPECT_TRUE(world_.setRelays("park", {false}));
    world_.switchRelaysByHand("road", {false, true});
    EXPECT_EQ(world_.losses("road"), 0) << "as written";
    world_.switchRelaysByHand("road", {true, true});
    world_.switchRelaysByHand("road", {false, false});
    EXPECT_EQ(world_.losses("road"), 1);
    EXPECT_THAT(world_.relays("road"), ElementsAre(false, false));
    EXPECT_THAT(world_.relays("park"), ElementsAre(false));
    EXPECT_EQ(world_.losses("park"), 0);
}

// A door opens whether or not the module that watches it has power.
TEST_F(WorldTest, contacts_move_while_nobody_is_connected_to_them) {
    world_.setPlugged("doors", false);
    world_.setContact("doors", 3, true);
    EXPECT_TRUE(world_.contact("doors", 3));
    world_.setContact("doors", 3, false);
    EXPECT_FALSE(world_.contact("doors", 3));
}

TEST_F(WorldTest, desk_frames_are_stamped_on_arrival_and_lost_with_the_plug) {
    clock_.advance(3s);
    send("a", 1);
    clock_.advance(1s);
    EXPECT_EQ(world_.takeFromDesk(2), std::nullopt);
    EXPECT_EQ(world_.takeFromDesk(1)->arrived, Time(3s));
    send("a", 2);
    world_.setPlugged("desk 1", false);
    send("a", 3);
    world_.setPlugged("desk 1", true);
    send("a", 4);
    EXPECT_THAT(takenFromDesk(1), ElementsAre("a4"));
}

TEST_F(WorldTest, a_desk_nobody_listens_to_keeps_the_newest_of_each_sender) {
    send("quiet", 7);
    for (int level = 1; level <= 100; ++level) send("loud", static_cast<std::uint8_t>(level));
    const auto frames = takenFromDesk(1);
    EXPECT_EQ(frames.size(), World::kDeskDepth);
    EXPECT_EQ(frames.front(), "quiet7");
    EXPECT_EQ(frames[1], "loud86");
    EXPECT_EQ(frames.back(), "loud100");
}

TEST_F(WorldTest, presses_wait_for_the_driver_but_not_over_a_loss) {
    clock_.advance(2s);
    world_.press(1, true);
    clock_.advance(1s);
    world_.press(1, false);
    EXPECT_EQ(world_.takePress()->at, Time(2s));
    EXPECT_FALSE(world_.takePress()->pressed);
    world_.press(2, true);
    world_.setPlugged("cue controller", false);
    world_.press(3, true);
    world_.setPlugged("cue controller", true);
    EXPECT_EQ(world_.takePress(), std::nullopt);
}

// Example failure: a projector whose cable was pulled goes on lighting the simulated wall with its
// last frame.
TEST_F(WorldTest, an_unplugged_projector_shows_nothing_until_its_next_frame) {
    const auto picture = std::make_shared<const RgbaImage>(2, 2);
    world_.setFrame("left", picture);
    world_.setFrame("right", picture);
    world_.setPlugged("left", false);
    EXPECT_EQ(world_.frame("left"), nullptr);
    EXPECT_EQ(world_.frame("right"), picture);
    world_.setFrame("left", picture);
    EXPECT_EQ(world_.frame("left"), nullptr);
    world_.setPlugged("left", true);
    EXPECT_EQ(world_.frame("left"), nullptr);
    world_.setFrame("left", picture);
    EXPECT_EQ(world_.frame("left"), picture);
}

TEST_F(WorldTest, the_camera_gives_the_newest_frame_that_is_due_once) {
    for (const std::uint64_t sequence : {1, 2, 3}) world_.sendFromCamera(cameraFrame(sequence), Time(sequence * 100ms));
    EXPECT_EQ(world_.takeFromCamera(), nullptr);
    clock_.advanceTo(200ms);
    EXPECT_EQ(world_.takeFromCamera()->sequence, 2u);
    EXPECT_EQ(world_.takeFromCamera(), nullptr);
    clock_.advanceTo(300ms);
    EXPECT_EQ(world_.takeFromCamera()->sequence, 3u);
}

TEST_F(WorldTest, camera_frames_on_their_way_are_lost_with_the_plug) {
    world_.sendFromCamera(cameraFrame(1), 100ms);
    world_.setPlugged("camera", false);
    world_.sendFromCamera(cameraFrame(2), 100ms);
    world_.setPlugged("camera", true);
    clock_.advanceTo(1s);
    EXPECT_EQ(world_.takeFromCamera(), nullptr);
}

// The lighting thread writes, the scene reads, the operator unplugs. A torn frame would mix two
// levels; races are for the thread sanitizer.
TEST_F(WorldTest, frames_are_whole_whoever_looks) {
    std::jthread lighting([&] {
        for (int frame = 0; frame < 1000; ++frame)
            world_.setSlots(1, frame % 2 ? bright_ : std::array<std::uint8_t, kDmxSlots>{});
    });
    std::jthread operatorsHand([&] {
        for (int time = 0; time < 1000; ++time) world_.setPlugged("universe 1", time % 2);
    });
    for (int look = 0; look < 1000; ++look) {
        const auto slots = world_.slots(1);
        ASSERT_EQ(std::count(slots.begin(), slots.end(), slots[0]), std::ssize(slots));
    }
}

}  // namespace
}  // namespace fantascope::site
