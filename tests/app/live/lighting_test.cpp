#include "app/live/lighting.h"

#include "app/running_show.h"

#include <gmock/gmock.h>

#include <condition_variable>
#include <mutex>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::Each;

// A bank that keeps what it is told.
class Noting final : public RelayBank {
public:
    Noting(std::unique_ptr<RelayBank> bank, std::vector<std::vector<bool>>& written)
        : bank_(std::move(bank)), written_(written) {}
    DeviceStatus status() const override { return bank_->status(); }
    std::size_t size() const override { return bank_->size(); }
    Result<void> write(const std::vector<bool>& states) override {
        written_.push_back(states);
        return bank_->write(states);
    }
    Result<std::vector<bool>> read() override {
        if (read_) return *read_;
        return bank_->read();
    }
    std::optional<std::vector<bool>> read_;  // what it says instead of the truth

private:
    std::unique_ptr<RelayBank> bank_;
    std::vector<std::vector<bool>>& written_;
};

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
    Lighting lighting_{run_.site, run_.inputs, run_.devices, run_.clock, show::ShowClock(), nullptr, run_.faults, run_.events};
    const std::vector<Part> relays_ = lighting_.relayParts();
};

TEST_F(LightingPart, brings_the_lamps_to_the_cue_and_dims_the_street) {
    run(1s);
    EXPECT_EQ(sculpture(), 0);
    EXPECT_THAT(run_.world.relays("road"), Each(true)) << "before the first cue the street is lit";
    run_.inputs.submit(run_.jumpTo("Full"));
    run(10s);
    EXPECT_EQ(sculpture(), 255);
    EXPECT_THAT(run_.world.relays("road"), Each(false));
}

// Example failure: relays are written when the show changes them and only then; after a lost bus
// the street stays lit all night.
TEST_F(LightingPart, gives_a_returned_relay_bank_its_states_again) {
    run_.inputs.submit(run_.jumpTo("Full"));
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
    run_.inputs.submit(run_.jumpTo("Full"));
    run(10s);
    run_.world.setPlugged("road", false);
    run_.world.setPlugged("road", true);
    EXPECT_THAT(run_.world.relays("road"), Each(true));
    run(1s);
    EXPECT_THAT(run_.world.relays("road"), Each(false));
}

// Somebody on a ladder tries the lamps, or the module was without power for a moment.
TEST_F(LightingPart, gives_relays_that_a_hand_switched_their_states_again) {
    run_.inputs.submit(run_.jumpTo("Full"));
    run(10s);
    run_.world.switchRelaysByHand("road", {true, false});
    run(1s);
    EXPECT_THAT(run_.world.relays("road"), Each(false));
}

TEST_F(LightingPart, a_lost_line_stops_neither_itself_nor_the_relays) {
    run(1s);
    run_.world.setPlugged("universe 1", false);
    run_.inputs.submit(run_.jumpTo("Full"));
    run(10s);
    EXPECT_EQ(sculpture(), 0);
    EXPECT_THAT(run_.world.relays("road"), Each(false));
    run_.world.setPlugged("universe 1", true);
    run(1s);
    EXPECT_EQ(sculpture(), 255);
}

// Example failure: the street is switched off and on at the start of a show that begins in a dark
// cue.
TEST_F(LightingPart, writes_no_relay_before_the_show_has_decided) {
    run_.inputs.submit(run_.jumpTo("Full"));
    std::vector<std::vector<bool>> written;
    run_.devices.relayBanks[0] = std::make_unique<Noting>(std::move(run_.devices.relayBanks[0]), written);
    for (const Part& part : relays_) part.work(run_.clock.now());
    EXPECT_TRUE(written.empty()) << "the lighting part has not worked yet";
    run(1s);
    EXPECT_THAT(written, testing::ElementsAre(std::vector<bool>{false, false}));
}

// Example failure: the sculpture stays at full all night, because the last frame stays in the
// dimmer.
TEST_F(LightingPart, fades_the_lamps_to_the_end_levels_and_makes_the_relays_safe_at_once) {
    run_.site.fixtures[0].end = {0.2f};
    run_.site.endFade = 2s;
    Lighting lighting(run_.site, run_.inputs, run_.devices, run_.clock, show::ShowClock(), nullptr, run_.faults, run_.events);
    const std::vector<Part> relays = lighting.relayParts();
    const auto work = [&] {
        lighting.tick(run_.clock.now());
        for (const Part& part : relays) part.work(run_.clock.now());
    };
    run_.inputs.submit(run_.jumpTo("Full"));
    run_.clock.advance(10s);
    work();
    ASSERT_EQ(sculpture(), 255);
    ASSERT_THAT(run_.world.relays("road"), Each(false));
    lighting.end(run_.clock.now());
    lighting.end(run_.clock.now() + 5s);  // only the first one counts
    EXPECT_FALSE(lighting.ended());
    EXPECT_THAT(lighting.unsafeBanks(), testing::ElementsAre(testing::Field(&UnsafeBank::name, "road")));
    std::vector<int> levels;
    for (int quarter = 0; quarter <= 4; ++quarter) {
        work();
        levels.push_back(sculpture());
        EXPECT_THAT(run_.world.relays("road"), Each(true));
        EXPECT_EQ(lighting.ended(), quarter == 4);
        run_.clock.advance(500ms);
    }
    EXPECT_THAT(levels, testing::ElementsAre(255, 204, 153, 102, 51));
    EXPECT_TRUE(lighting.unsafeBanks().empty());
    run_.inputs.submit(run_.jumpTo("Full"));
    run_.clock.advance(10s);
    work();
    EXPECT_EQ(sculpture(), 51) << "the show no longer decides";
    EXPECT_THAT(run_.world.relays("road"), Each(true));
}

// A trim takes from what the cue asks. It takes nothing from a blackout, from the end levels and
// from the relays' safe states. Example failure: the show ends, and the street stays dark because
// of a shop window.
TEST_F(LightingPart, gives_less_by_a_trim_but_not_at_the_end) {
    run_.site.fixtures[0].end = {0.4f};
    run_.site.endFade = 1s;
    run_.site.corrections.lamps.fixtures = {0};
    run_.site.corrections.lamps.relays = {1, 0};
    show::CueList cues = run_.cues;
    cues.trim = {0.2f, 0.05, 2, 10s};
    for (show::CueList::Cue& cue : cues.cues) cue.look.relays = {1, 1};
    show::InputLog inputs(cues);
    Lighting lighting(run_.site, inputs, run_.devices, run_.clock, show::ShowClock(), nullptr, run_.faults, run_.events);
    const std::vector<Part> relays = lighting.relayParts();
    const auto work = [&](Time time) {
        run_.clock.advance(time);
        lighting.tick(run_.clock.now());
        for (const Part& part : relays) part.work(run_.clock.now());
    };
    const auto trim = [&](float share, int relaysOff) {
        const show::Input input{.at = run_.clock.now(), .kind = show::Input::Kind::Trim, .trim = {share, relaysOff}};
        EXPECT_EQ(inputs.submit(input).outcome, show::Outcome::Taken);
    };
    inputs.submit(run_.jumpTo("Full"));
    work(10s);
    ASSERT_EQ(sculpture(), 255);
    trim(0.4f, 1);
    work(4s);
    EXPECT_EQ(sculpture(), 204) << "0.05 a second";
    EXPECT_THAT(run_.world.relays("road"), testing::ElementsAre(true, false));
    work(20s);
    EXPECT_EQ(sculpture(), 102);
    inputs.submit({.at = run_.clock.now(), .kind = show::Input::Kind::Dark});
    work(10s);
    EXPECT_EQ(sculpture(), 0);
    EXPECT_THAT(run_.world.relays("road"), Each(true)) << "a dark picture is no reason for dark streets";
    inputs.submit({.at = run_.clock.now(), .kind = show::Input::Kind::Light});
    work(10s);
    trim(0.2f, 2);
    work(10s);
    EXPECT_EQ(sculpture(), 51);
    EXPECT_THAT(run_.world.relays("road"), Each(false));
    lighting.end(run_.clock.now());
    work(Time{});
    EXPECT_EQ(sculpture(), 51) << "from where they are";
    EXPECT_THAT(run_.world.relays("road"), Each(true));
    work(2s);
    EXPECT_EQ(sculpture(), 102);
}

// Nobody waits for the fade where a display hangs, or somebody is impatient.
// Example failure: the lamps stay at the level of that moment until the morning.
TEST_F(LightingPart, hurried_jumps_to_the_end_levels_with_one_frame_and_says_which_line_has_not_taken_it) {
    run_.site.fixtures[0].end = {0.2f};
    run_.site.endFade = 60s;
    for (const bool isThere : {true, false}) {
        Lighting lighting(run_.site, run_.inputs, run_.devices, run_.clock, show::ShowClock(), nullptr, run_.faults, run_.events);
        const std::vector<Part> relays = lighting.relayParts();
        const auto work = [&] {
            lighting.tick(run_.clock.now());
            for (const Part& part : relays) part.work(run_.clock.now());
        };
        run_.inputs.submit(run_.jumpTo("Full"));
        run_.clock.advance(10s);
        work();
        ASSERT_EQ(sculpture(), 255);
        EXPECT_EQ(lighting.unendedLines().size(), run_.site.universes.size());
        lighting.end(run_.clock.now());
        run_.clock.advance(1s);
        work();
        EXPECT_GT(sculpture(), 250);
        EXPECT_FALSE(lighting.ended());
        EXPECT_EQ(lighting.unendedLines().size(), run_.site.universes.size()) << "none is there yet";
        run_.world.setPlugged("universe 1", isThere);
        lighting.hurry();
        work();
        EXPECT_TRUE(lighting.ended());
        if (isThere) {
            EXPECT_EQ(sculpture(), 51);
            EXPECT_TRUE(lighting.unendedLines().empty());
        } else {
            ASSERT_EQ(lighting.unendedLines().size(), 1u);
            EXPECT_THAT(sentenceOf(lighting.unendedLines()[0]),
                        testing::StartsWith("the lamps of universe 1 did not get their end levels (universe 1 is absent"));
        }
    }
}

TEST_F(LightingPart, a_bank_that_comes_back_while_the_show_ends_gets_its_safe_states) {
    run_.inputs.submit(run_.jumpTo("Full"));
    run(10s);
    run_.world.setPlugged("road", false);
    lighting_.end(run_.clock.now());
    run(3s);
    EXPECT_FALSE(lighting_.ended());
    EXPECT_THAT(lighting_.unsafeBanks(),
                testing::ElementsAre(testing::AllOf(testing::Field(&UnsafeBank::name, "road"),
                                                    testing::Field(&UnsafeBank::why, testing::HasSubstr("road is absent: ")))));
    run_.world.setPlugged("road", true);
    run_.world.switchRelaysByHand("road", {false, true});
    run(100ms);
    EXPECT_TRUE(lighting_.ended());
    EXPECT_THAT(run_.world.relays("road"), Each(true));
}

// Relays that the show left safe are asked once more: somebody may have switched them since.
// Example failure: a street lamp that was switched off by hand in the last second stays off.
TEST_F(LightingPart, asks_relays_that_are_safe_already_whether_they_are) {
    run(1s);
    std::vector<std::vector<bool>> written;
    run_.devices.relayBanks[0] = std::make_unique<Noting>(std::move(run_.devices.relayBanks[0]), written);
    lighting_.end(run_.clock.now());
    run(2s);
    EXPECT_TRUE(lighting_.ended());
    EXPECT_TRUE(written.empty());

    Lighting another(run_.site, run_.inputs, run_.devices, run_.clock, show::ShowClock(), nullptr, run_.faults, run_.events);
    const std::vector<Part> relays = another.relayParts();
    another.tick(run_.clock.now());
    relays[0].work(run_.clock.now());
    ASSERT_EQ(written.size(), 1u);
    static_cast<Noting&>(*run_.devices.relayBanks[0]).read_ = {true, false};
    another.end(run_.clock.now());
    relays[0].work(run_.clock.now());
    EXPECT_EQ(written.size(), 2u);
}

// A bank with a relay that stays off, as one with a burnt coil does.
class Stuck final : public RelayBank {
public:
    explicit Stuck(std::vector<std::vector<bool>>& written) : written_(written) {}
    DeviceStatus status() const override { return {"road", "stuck", DeviceState::Running, LossAction::Hold, "", 0}; }
    std::size_t size() const override { return 2; }
    Result<void> write(const std::vector<bool>& states) override {
        written_.push_back(states);
        is_ = {states[0], false};
        if (states == is_) return {};
        return Error("road: its read-back differs");
    }
    Result<std::vector<bool>> read() override { return is_; }

private:
    std::vector<std::vector<bool>>& written_;
    std::vector<bool> is_{false, false};
};

class LightingWithFaults : public LightingPart {
protected:
    std::vector<std::string> told() const { return run_.told(); }

    std::vector<std::vector<bool>> written_;
    Lighting watched_{run_.site, run_.inputs, run_.devices, run_.clock, show::ShowClock(), nullptr, run_.faults, run_.events};
    const std::vector<Part> watchedRelays_ = watched_.relayParts();

    void runWatched(Time time) {
        for (const Time end = run_.clock.now() + time; run_.clock.now() < end; run_.clock.advance(25ms)) {
            watched_.tick(run_.clock.now());
            for (const Part& part : watchedRelays_) part.work(run_.clock.now());
        }
    }
};

// Example failure: 20 writes a second for ever, and nobody is told.
TEST_F(LightingWithFaults, relays_that_do_not_follow_are_told_once_and_tried_ever_more_rarely) {
    run_.devices.relayBanks[0] = std::make_unique<Stuck>(written_);
    runWatched(60s);
    EXPECT_LE(written_.size(), 20u);
    EXPECT_GE(written_.size(), 60u / 5u);
    ASSERT_THAT(told(), testing::SizeIs(1));
    EXPECT_THAT(told()[0], testing::StartsWith("road-south of 'road' did not switch (road: its read-back differs)"));
    EXPECT_EQ(run_.faults.faults()[0].device, "road");
    EXPECT_EQ(run_.faults.faults()[0].until, std::nullopt);

    written_.clear();
    show::Input cue = run_.jumpTo("Full");
    run_.inputs.submit(cue);
    runWatched(25ms);
    EXPECT_THAT(written_, testing::ElementsAre(std::vector<bool>{false, false})) << "a new cue is written at once";
    runWatched(6s);
    EXPECT_THAT(told(),
                testing::ElementsAre(testing::_, testing::StartsWith("the relays of 'road' are as they should be after")));

    written_.clear();
    watched_.end(run_.clock.now());
    runWatched(2s);
    EXPECT_EQ(written_.size(), 80u) << "at the end nothing is waited for";
    ASSERT_THAT(watched_.unsafeBanks(), testing::SizeIs(1));
    EXPECT_EQ(watched_.unsafeBanks()[0].why, "road: its read-back differs");
}

// Another program has the module, too. Example failure: both switch the street eight times a
// second.
TEST_F(LightingWithFaults, relays_that_somebody_else_switches_are_switched_back_ever_more_rarely) {
    run_.devices.relayBanks[0] = std::make_unique<Noting>(std::move(run_.devices.relayBanks[0]), written_);
    run_.inputs.submit(run_.jumpTo("Full"));
    for (int time = 0; time < 4 * 60; ++time) {
        runWatched(250ms);
        run_.world.switchRelaysByHand("road", {true, false});
    }
    EXPECT_LE(written_.size(), 20u);
    EXPECT_THAT(told(), testing::ElementsAre(testing::StartsWith("road-north of 'road' switched without the show")));
    runWatched(20s);
    EXPECT_THAT(told(),
                testing::ElementsAre(testing::_, testing::StartsWith("the relays of 'road' are as they should be after")));
}

TEST_F(LightingWithFaults, a_universe_that_a_desk_takes_is_a_fault_until_it_gives_it_back) {
    run_.site.universes[0].desk = show::Desk{run_.site.universes[0].port, {.ownPriority = 100}};
    run_.devices = valueOf(openDevices(run_.site, Backends::SimulatedHeadless, {run_.clock, &run_.world}));
    Lighting lighting{run_.site, run_.inputs, run_.devices, run_.clock, show::ShowClock(), nullptr, run_.faults, run_.events};
    for (const bool ended : {false, true}) {
        DmxInput frame;
        frame.source = "FOH";
        frame.priority = 120;
        frame.ended = ended;
        run_.world.sendFromDesk(1, frame);
        lighting.tick(run_.clock.now());
        run_.clock.advance(2s);
    }
    EXPECT_THAT(told(), testing::ElementsAre("universe 1 is now sent by 'FOH'", "universe 1 is now sent by the show"));
    ASSERT_THAT(run_.faults.faults(), testing::SizeIs(1));
    EXPECT_EQ(run_.faults.faults()[0].device, "universe 1");
    EXPECT_EQ(run_.faults.faults()[0].until, 2s);
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
    Lighting lighting{run.site, run.inputs, run.devices, run.clock, show::ShowClock(), nullptr, run.faults, run.events};
    const std::vector<Part> parts = lighting.relayParts();
    ASSERT_EQ(parts.size(), 2u);
    const auto enter = [&](const char* cue) {
        run.inputs.submit(run.jumpTo(cue));
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

// Example failure: one thread for all relays, and a module without power holds up the street lamps
// of the others by its time-out, again and again.
TEST(LightingWithSeveralBanks, a_bank_that_hangs_holds_up_no_other) {
    OnTwoBanks run;
    auto made = std::make_unique<Hanging>();
    Hanging& hanging = *made;
    run.devices.relayBanks[0] = std::move(made);
    SteadyClock clock;
    const Time start = clock.now();
    Lighting lighting{run.site, run.inputs, run.devices, clock, show::ShowClock(start), nullptr, run.faults, run.events};
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
        run.inputs.submit(jump);
        const std::vector<bool> wanted = {false, cue == std::string_view("Farewell")};
        EXPECT_TRUE(comesTrue([&] { return run.world.relays("park") == wanted; })) << cue;
    }
    EXPECT_EQ(hanging.written().size(), 1u) << "its one call has not ended";
    hanging.letGo();
    EXPECT_TRUE(comesTrue([&] { return hanging.written().back() == std::vector<bool>{false}; })) << "then it gets the newest";
    EXPECT_EQ(hanging.written().size(), 2u) << "and none that is over";
}

// A desk of higher priority has the whole universe. After its termination packet the show has it
// again. The operator is told of both. Example failure: the show's levels flicker between the
// desk's frames.
TEST(LightingWithADesk, gives_the_universe_away_and_takes_it_back) {
    RunningShow run;
    run.site.universes[0].desk = show::Desk{run.site.universes[0].port, {.ownPriority = 100}};
    run.devices = valueOf(openDevices(run.site, Backends::SimulatedHeadless, {run.clock, &run.world}));
    Lighting lighting{run.site, run.inputs, run.devices, run.clock, show::ShowClock(), nullptr, run.faults, run.events};
    run.inputs.submit(run.jumpTo("Full"));
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
    EXPECT_THAT(run.told(), testing::ElementsAre("universe 1 is now sent by 'FOH'", "universe 1 is now sent by the show"));
}

// Who moved a slot last has it: the show must not take it in order to darken it.
TEST(LightingWithADesk, leaves_a_desk_what_it_has_when_the_show_ends) {
    RunningShow run;
    run.site.universes[0].desk = show::Desk{run.site.universes[0].port, {.rule = show::DmxMerge::Rule::Latest}};
    run.devices = valueOf(openDevices(run.site, Backends::SimulatedHeadless, {run.clock, &run.world}));
    Lighting lighting{run.site, run.inputs, run.devices, run.clock, show::ShowClock(), nullptr, run.faults, run.events};
    run.inputs.submit(run.jumpTo("Full"));
    const auto pass = [&](Time time) {
        for (const Time end = run.clock.now() + time; run.clock.now() < end; run.clock.advance(tickTime(1, Lighting::kRate))) {
            DmxInput frame;
            frame.source = "FOH";
            frame.slots[0] = run.clock.now() < 10s ? 0 : 40;
            run.world.sendFromDesk(1, frame);
            lighting.tick(run.clock.now());
        }
    };
    pass(11s);
    ASSERT_EQ(run.world.slots(1)[0], 40);
    lighting.end(run.clock.now());
    pass(2s);
    EXPECT_TRUE(lighting.unsafeBanks().size() == 1) << "no bank has worked here";
    EXPECT_EQ(run.world.slots(1)[0], 40);
}

}  // namespace
}  // namespace fantascope::app
