#include "app/lighting.h"

#include "app/running_show.h"

#include <gmock/gmock.h>

#include <condition_variable>
#include <mutex>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::Each;

class LightingPart : public testing::Test {
protected:
    // All parts, as often as they would work in `time`.
    void run(Time time) {
        for (const Time end = run_.clock.now() + time; run_.clock.now() < end; run_.clock.advance(tickTime(1, Lighting::kRate))) {
            lighting_.tick(run_.clock.now());
            for (const Part& part : relays_) part.work(run_.clock.now());
        }
    }
    int sculpture() const { return run_.world.slots(1)[0]; }

    RunningShow run_;
    Lighting lighting_{run_.site, run_.cues, run_.devices, run_.clock, Time{}, nullptr};
    const std::vector<Part> relays_ = lighting_.relayParts();
};

TEST_F(LightingPart, brings_the_lamps_to_the_cue_and_dims_the_street) {
    run(1s);
    EXPECT_EQ(sculpture(), 0);
    EXPECT_THAT(run_.world.relays("road"), Each(true)) << "before the first cue the street is lit";
    ASSERT_TRUE(lighting_.replica().give(run_.jumpTo("Full")));
    run(10s);
    EXPECT_EQ(sculpture(), 255);
    EXPECT_THAT(run_.world.relays("road"), Each(false));
}

// Example failure: relays are written when the show changes them and only then; after a lost bus the street stays lit all night.
TEST_F(LightingPart, gives_a_returned_relay_bank_its_states_again) {
    ASSERT_TRUE(lighting_.replica().give(run_.jumpTo("Full")));
    run(10s);
    for (int loss = 0; loss < 2; ++loss) {
        run_.world.setPlugged("road", false);
        run(1s);
        EXPECT_THAT(run_.world.relays("road"), Each(true)) << "a bank that is alone takes its safe states";
        run_.world.setPlugged("road", true);
        run(1s);
        EXPECT_THAT(run_.world.relays("road"), Each(false));
    }
}

// The loss is over before anybody looked.
TEST_F(LightingPart, notices_a_loss_between_two_looks) {
    ASSERT_TRUE(lighting_.replica().give(run_.jumpTo("Full")));
    run(10s);
    run_.world.setPlugged("road", false);
    run_.world.setPlugged("road", true);
    EXPECT_THAT(run_.world.relays("road"), Each(true));
    run(1s);
    EXPECT_THAT(run_.world.relays("road"), Each(false));
}

// Somebody on a ladder tries the lamps, or the module was without power for a moment.
TEST_F(LightingPart, gives_relays_that_a_hand_switched_their_states_again) {
    ASSERT_TRUE(lighting_.replica().give(run_.jumpTo("Full")));
    run(10s);
    run_.world.switchRelaysByHand("road", {true, false});
    run(1s);
    EXPECT_THAT(run_.world.relays("road"), Each(false));
}

TEST_F(LightingPart, a_lost_line_stops_neither_itself_nor_the_relays) {
    run(1s);
    run_.world.setPlugged("universe 1", false);
    ASSERT_TRUE(lighting_.replica().give(run_.jumpTo("Full")));
    run(10s);
    EXPECT_EQ(sculpture(), 0);
    EXPECT_THAT(run_.world.relays("road"), Each(false));
    run_.world.setPlugged("universe 1", true);
    run(1s);
    EXPECT_EQ(sculpture(), 255);
}

// The default show, whose road lamps hang on a module each.
struct OnTwoBanks : RunningShow {
    OnTwoBanks() {
        site.relayBanks.push_back({"park", site.relayBanks[0].device});
        site.relays[1].bank = 1;
        devices = {};  // first, so that the old bank's farewell does not disturb the new ones
        devices = valueOf(openDevices(site, Backends::SimulatedHeadless, {clock, &world}));
    }
};

TEST(LightingWithSeveralBanks, gives_each_bank_its_own_relays_and_loses_one_alone) {
    OnTwoBanks run;
    Lighting lighting{run.site, run.cues, run.devices, run.clock, Time{}, nullptr};
    const std::vector<Part> parts = lighting.relayParts();
    ASSERT_EQ(parts.size(), 2u);
    const auto enter = [&](const char* cue) {
        ASSERT_TRUE(lighting.replica().give(run.jumpTo(cue)));
        run.clock.advance(1s);
        lighting.tick(run.clock.now());
        for (const Part& part : parts) part.work(run.clock.now());
    };
    const std::vector<bool> onlyCoil0On = {true}, coils0And1Off = {false, false};
    EXPECT_EQ(run.world.relays("road"), onlyCoil0On);
    enter("Full");
    EXPECT_EQ(run.world.relays("road"), std::vector<bool>{false});
    EXPECT_EQ(run.world.relays("park"), coils0And1Off);
    run.world.setPlugged("park", false);
    EXPECT_EQ(run.world.relays("park"), (std::vector<bool>{false, true}));
    enter("Farewell");
    EXPECT_EQ(run.world.relays("road"), onlyCoil0On);
    enter("Full");
    run.world.setPlugged("park", true);
    enter("Full");
    EXPECT_EQ(run.world.relays("road"), std::vector<bool>{false});
    EXPECT_EQ(run.world.relays("park"), coils0And1Off);
}

// A bank whose module has died in the middle of a call: that ends when somebody lets it.
class Hanging final : public RelayBank {
public:
    DeviceStatus status() const override { return {"road", "hanging", DeviceState::Running, LossAction::Hold, "", 0}; }
    std::size_t size() const override { return 1; }
    Result<void> write(const std::vector<bool>& states) override {
        std::unique_lock lock(mutex_);
        written_.push_back(states);
        change_.notify_all();
        change_.wait(lock, [&] { return !hangs_; });
        return {};
    }
    Result<std::vector<bool>> read() override { return Error("it hangs"); }

    void letGo() {
        const std::lock_guard lock(mutex_);
        hangs_ = false;
        change_.notify_all();
    }
    std::vector<std::vector<bool>> written() const {
        const std::lock_guard lock(mutex_);
        return written_;
    }

private:
    mutable std::mutex mutex_;
    std::condition_variable change_;
    bool hangs_ = true;
    std::vector<std::vector<bool>> written_;
};

// Example failure: one thread for all relays, and a module without power holds up the street lamps of the others by its time-out, again and again.
TEST(LightingWithSeveralBanks, a_bank_that_hangs_holds_up_no_other) {
    OnTwoBanks run;
    auto made = std::make_unique<Hanging>();
    Hanging& hanging = *made;
    run.devices.relayBanks[0] = std::move(made);
    SteadyClock clock;
    const Time start = clock.now();
    Lighting lighting{run.site, run.cues, run.devices, clock, start, nullptr};
    std::vector<Part> parts = lighting.relayParts();
    parts.push_back({"lighting", Lighting::kRate, start, [&](Time moment) { lighting.tick(moment); }, Rank::Lighting});
    const PartThreads threads(clock, std::move(parts));
    const auto comesTrue = [&](const auto& condition) {
        for (const Time latest = clock.now() + 30s; !condition();) {
            if (clock.now() > latest) return false;
            clock.sleepUntil(clock.now() + 1ms);
        }
        return true;
    };
    EXPECT_TRUE(comesTrue([&] { return hanging.written().size() == 1; }));
    for (const char* cue : {"Full", "Farewell", "Full", "Farewell", "Full"}) {
        show::Input jump = run.jumpTo(cue);
        jump.at = clock.now() - start;
        ASSERT_TRUE(lighting.replica().give(jump));
        const std::vector<bool> wanted = {false, cue == std::string_view("Farewell")};
        EXPECT_TRUE(comesTrue([&] { return run.world.relays("park") == wanted; })) << cue;
    }
    EXPECT_EQ(hanging.written().size(), 1u) << "its one call has not ended";
    hanging.letGo();
    EXPECT_TRUE(comesTrue([&] { return hanging.written().back() == std::vector<bool>{false}; })) << "then it gets the newest";
    EXPECT_EQ(hanging.written().size(), 2u) << "and none that is over";
}

// A desk of higher priority has the universe whole; when it says goodbye the show has it again, and the operator knows who has.
// Example failure: the show's levels flicker between the desk's frames.
TEST(LightingWithADesk, gives_the_universe_away_and_takes_it_back) {
    RunningShow run;
    run.site.universes[0].desk = show::Desk{run.site.universes[0].port, {.ownPriority = 100}};
    run.devices = valueOf(openDevices(run.site, Backends::SimulatedHeadless, {run.clock, &run.world}));
    Lighting lighting{run.site, run.cues, run.devices, run.clock, Time{}, nullptr};
    std::vector<std::string> told;
    lighting.tell = [&](const std::string& sentence) { told.push_back(sentence); };
    ASSERT_TRUE(lighting.replica().give(run.jumpTo("Full")));
    std::vector<int> seen;
    const auto pass = [&](Time time, std::optional<int> level, bool ended = false) {
        for (const Time end = run.clock.now() + time; run.clock.now() < end; run.clock.advance(tickTime(1, Lighting::kRate))) {
            if (level) {
                DmxInput frame;
                frame.slots.fill(static_cast<std::uint8_t>(*level));
                frame.source = "FOH";
                frame.priority = 120;
                frame.ended = ended;
                run.world.sendFromDesk(1, frame);
            }
            lighting.tick(run.clock.now());
            if (const int slot = run.world.slots(1)[0]; seen.empty() || seen.back() != slot) seen.push_back(slot);
        }
    };
    pass(10s, {});
    EXPECT_EQ(seen.back(), 255);
    seen.clear();
    pass(5s, 40);
    pass(50ms, 40, true);
    pass(1s, {});
    EXPECT_THAT(seen, testing::ElementsAre(40, 255));
    EXPECT_THAT(told, testing::ElementsAre("universe 1 is now sent by 'FOH'", "universe 1 is now sent by the show"));
}

}  // namespace
}  // namespace fantascope::app
