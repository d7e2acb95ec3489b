#include "app/live/hand.h"

#include "app/live/run_report.h"
#include "app/running_show.h"

#include <gmock/gmock.h>

#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

class HandPart : public testing::Test {
protected:
    void press(show::Button button) {
        hand_.tick(run_.clock.now());  // it looks all the time
        for (const bool down : {true, false}) run_.world.press(run_.buttonOf(button), down);
        hand_.tick(run_.clock.now());
    }
    show::ShowState stateOfLamps() {
        show::ShowState state;
        lamps_.stateAt(run_.clock.now(), state);
        return state;
    }

    RunningShow run_;
    show::PlaybackReplica lamps_{run_.inputs};
    Hand hand_{run_.played, run_.inputs, run_.site, run_.devices, show::ShowClock(), run_.events};
};

TEST_F(HandPart, a_press_reaches_every_part_of_the_show_and_the_operator) {
    run_.clock.advance(2s);
    press(show::Button::Go);
    EXPECT_EQ(stateOfLamps().cue, 0);
    EXPECT_THAT(run_.told(), ElementsAre("cue 1 of 6: Dusk"));
    run_.clock.advance(2s);
    press(show::Button::Blackout);
    EXPECT_TRUE(stateOfLamps().blackout);
    EXPECT_THAT(run_.told(), Contains("blackout: pictures and lamps are dark"));
    press(show::Button::Blackout);
    EXPECT_EQ(run_.told().back(), "light: the blackout is over");
    RunReport report;
    addEvents(run_.events, report);
    const std::vector<CueReport>& cues = report.cues;
    ASSERT_EQ(cues.size(), 1u);
    EXPECT_EQ(cues[0].name, "Dusk");
    EXPECT_EQ(cues[0].entered, 2s);
}

TEST_F(HandPart, tells_what_the_operator_holds) {
    using Kind = show::Input::Kind;
    run_.clock.advance(2s);
    const auto told = [&](show::Input input) {
        input.at = run_.clock.now();
        run_.inputs.submit(input);
        hand_.tick(run_.clock.now());
        return run_.told().back();
    };
    EXPECT_EQ(told({.kind = Kind::Load, .cue = 3}), "GO enters cue 4 of 6: " + run_.show.cues[3].name);
    EXPECT_EQ(told({.kind = Kind::Load, .cue = -1}), "GO enters the next cue");
    EXPECT_EQ(told({.kind = Kind::Pause}), "paused: the cues stand still");
    EXPECT_EQ(told({.kind = Kind::Pause}), "the cues go on");
    EXPECT_EQ(told({.kind = Kind::Freeze}), "frozen: what is seen stays, the cues go on unseen");
    EXPECT_EQ(told({.kind = Kind::Master, .level = 0.7f}), "master 70 %");
    const std::string lamp = run_.site.fixtures[0].name;
    EXPECT_EQ(told({.kind = Kind::Highlight, .fixture = 0}), "highlight: '" + lamp + "' is at full");
    EXPECT_EQ(told({.kind = Kind::Solo}), "solo: nothing is seen but '" + lamp + "', at full");
    EXPECT_EQ(told({.kind = Kind::Level, .level = 0.4f}), "solo: nothing is seen but '" + lamp + "', at 40 %");
    EXPECT_EQ(told({.kind = Kind::Park, .fixture = 0}), "parked: '" + lamp + "' stays as it is");
    EXPECT_EQ(told({.kind = Kind::Park, .fixture = 0}), "'" + lamp + "' is parked no more");
    EXPECT_EQ(told({.kind = Kind::Raise, .level = 0.4f, .fixture = 0}), "by hand: '" + lamp + "' at 40 % at least");
    EXPECT_EQ(told({.kind = Kind::Raise, .level = 0, .fixture = 0}), "'" + lamp + "' is as the cues have it");
    const std::string relay = run_.site.relays[0].name;
    EXPECT_EQ(told({.kind = Kind::Switch, .relay = 0, .on = true}),
              "by hand: relay '" + relay + "' is on until a cue switches it");
    EXPECT_EQ(told({.kind = Kind::Release}), "relay '" + relay + "' is as the cues have it");
    EXPECT_EQ(told({.kind = Kind::Highlight}), "no lamp is highlighted any more");
    EXPECT_EQ(told({.kind = Kind::Panic}), "PANIC: pictures and lamps go dark, relays are safe, the cues stand still");
    EXPECT_EQ(told({.kind = Kind::Go}), "ignored: all is dark after a panic; restore comes first");
    EXPECT_EQ(told({.kind = Kind::Restore}), "restored: the show goes on from where it was");
}

// GO enters the loaded cue, and nothing is loaded any more: that needs no news of its own.
TEST_F(HandPart, tells_of_the_loaded_cue_that_go_has_entered_once) {
    run_.clock.advance(2s);
    run_.inputs.submit({.at = 2s, .kind = show::Input::Kind::Load, .cue = 3});
    hand_.tick(run_.clock.now());
    press(show::Button::Go);
    EXPECT_THAT(run_.told(),
                ElementsAre("GO enters cue 4 of 6: " + run_.show.cues[3].name, "cue 4 of 6: " + run_.show.cues[3].name));
}

// Example failure: somebody writes a cue before the one that is on, and the terminal tells that a
// cue was entered.
TEST_F(HandPart, tells_nothing_of_a_cue_that_goes_on_after_a_revision) {
    press(show::Button::Go);
    run_.inputs.submit({.at = run_.clock.now(), .kind = show::Input::Kind::Load, .cue = 3});
    hand_.tick(run_.clock.now());
    const std::size_t before = run_.told().size();
    show::Revision revised{run_.show, run_.site, {}, {}};
    revised.show.cues.insert(revised.show.cues.begin(), revised.show.cues[0]);
    revised.show.cues[0].name = "Overture";
    revised.cues = valueOf(revised.show.bind(run_.site));
    const auto shared = std::make_shared<const show::Revision>(std::move(revised));
    const int number = run_.inputs.add(show::Revision::cuesOf(shared));
    EXPECT_TRUE(run_.played.revise(shared, [&] {
        const auto logged = run_.inputs.submit({.at = run_.clock.now(), .kind = show::Input::Kind::Revise, .revision = number});
        return logged.outcome == show::Outcome::Taken;
    }));
    hand_.tick(run_.clock.now());
    EXPECT_EQ(run_.told().size(), before);
    run_.clock.advance(1s);
    press(show::Button::Go);
    EXPECT_EQ(run_.told().back(), "cue 4 (5 of 7): " + run_.show.cues[3].name) << "the loaded one";
}

// Example failure: a press of a show that was resumed after three hours counts as one from before
// its cues.
TEST_F(HandPart, of_a_resumed_show_stamps_presses_with_show_time) {
    Hand hand{run_.played, run_.inputs, run_.site, run_.devices, show::ShowClock(1s, 3h), run_.events};
    run_.clock.advance(2s);
    run_.world.press(run_.buttonOf(show::Button::Go), true);
    run_.clock.advance(5ms);
    hand.tick(run_.clock.now());
    show::InputLog::Reader inputs = run_.inputs.reader();
    EXPECT_EQ(inputs.next()->input.at, 3h + 1s) << "when it was pressed, and not when it was asked for";
    RunReport report;
    addEvents(run_.events, report);
    EXPECT_EQ(report.cues.at(0).entered, 3h + 1s + 5ms);
}

// Example failure: a part whose thread stood still for a while stays in a cue that the others have
// left.
TEST_F(HandPart, a_part_that_has_not_looked_for_long_misses_no_input) {
    for (int input = 0; input < 999; ++input) run_.inputs.submit({2s, show::Input::Kind::Blackout});
    run_.inputs.submit(run_.jumpTo("Full"));
    run_.clock.advance(3s);
    const show::ShowState state = stateOfLamps();
    EXPECT_EQ(state.inputs, 1000u);
    EXPECT_TRUE(state.blackout);
    EXPECT_EQ(run_.show.cues[static_cast<std::size_t>(state.cue)].name, "Full");
}

// Otherwise the operator presses again, harder.
TEST_F(HandPart, says_why_a_press_did_nothing) {
    run_.clock.advance(2s);
    press(show::Button::Back);
    EXPECT_THAT(run_.told(), Contains(HasSubstr("ignored")));
    EXPECT_EQ(stateOfLamps().cue, -1);
}

TEST_F(HandPart, a_controller_that_is_pulled_out_and_put_back_presses_nothing) {
    run_.clock.advance(2s);
    run_.world.press(run_.buttonOf(show::Button::Go), true);
    run_.world.setPlugged("cue controller", false);
    hand_.tick(run_.clock.now());
    run_.clock.advance(2s);
    run_.world.setPlugged("cue controller", true);
    hand_.tick(run_.clock.now());
    EXPECT_EQ(stateOfLamps().cue, -1);
    press(show::Button::Go);
    EXPECT_EQ(stateOfLamps().cue, 0);
}

// What a button of the default show is good for, as its lamp says it. Cue 1 (Dusk) takes some
// seconds to come.
TEST_F(HandPart, lights_the_buttons_by_what_a_press_would_do) {
    using enum ButtonLight::State;
    bool editing = false;
    hand_.editing = [&] { return editing; };
    const auto lit = [&](show::Button button) {
        hand_.tick(run_.clock.now());
        return run_.world.light(run_.buttonOf(button)).state;
    };
    EXPECT_EQ(lit(show::Button::Go), Ready);
    EXPECT_EQ(lit(show::Button::Back), Off) << "there is no cue before";
    EXPECT_EQ(lit(show::Button::Blackout), Off);
    EXPECT_EQ(run_.world.light(run_.buttonOf(show::Button::Blackout)).word, "DARK");

    run_.clock.advance(2s);
    press(show::Button::Go);
    EXPECT_EQ(lit(show::Button::Go), Active) << "it fades";
    run_.clock.advance(run_.cues.cues[0].fade.in);
    EXPECT_EQ(lit(show::Button::Go), Ready);
    EXPECT_EQ(lit(show::Button::Back), Off);
    press(show::Button::Go);
    EXPECT_EQ(lit(show::Button::Back), Ready);

    for (const bool locked : {true, false}) {
        run_.inputs.submit({run_.clock.now(), show::Input::Kind::Lock});
        EXPECT_EQ(lit(show::Button::Back), locked ? Off : Ready);
        EXPECT_THAT(run_.told(), Contains(HasSubstr(locked ? "locked: hand controller" : "unlocked: hand controller")));
    }

    press(show::Button::Blackout);
    EXPECT_EQ(lit(show::Button::Blackout), Alarm);
    press(show::Button::Blackout);
    EXPECT_EQ(lit(show::Button::Blackout), Off);

    run_.inputs.submit(run_.jumpTo(run_.show.cues.back().name));
    run_.clock.advance(run_.cues.cues.back().fade.in);
    EXPECT_EQ(lit(show::Button::Go), Off) << "this is the last cue";
    EXPECT_EQ(lit(show::Button::Back), Ready);
}

// Counts what it is told, and is otherwise not there.
class CountingController final : public CueController {
public:
    explicit CountingController(std::vector<std::pair<int, ButtonLight>>& told) : told_(told) {}
    DeviceStatus status() const override { return {}; }
    std::optional<ButtonEvent> poll() override { return std::nullopt; }
    void light(int button, const ButtonLight& light) override { told_.emplace_back(button, light); }

private:
    std::vector<std::pair<int, ButtonLight>>& told_;
};

TEST(HandLights, are_told_once_a_change_and_of_editing_too) {
    using enum ButtonLight::State;
    using testing::Pair;
    RunningShow run;
    std::vector<std::pair<int, ButtonLight>> told;
    run.site.buttons = {{4, show::Button::Go}, {7, show::Button::Edit}, {9, show::Button::Left}};
    run.devices.cueController = std::make_unique<CountingController>(told);
    Hand hand{run.played, run.inputs, run.site, run.devices, show::ShowClock(), run.events};
    bool editing = false;
    hand.editing = [&] { return editing; };
    const auto toldIn = [&](Time length) {
        told.clear();
        for (const Time end = run.clock.now() + length; run.clock.now() < end; run.clock.advance(5ms)) hand.tick(run.clock.now());
        return told;
    };
    EXPECT_THAT(toldIn(1s), ElementsAre(Pair(4, ButtonLight{Ready, "GO"}), Pair(7, ButtonLight{Off, "EDIT"}),
                                        Pair(9, ButtonLight{Off, "LEFT"})));
    EXPECT_THAT(toldIn(1s), ElementsAre());
    editing = true;
    EXPECT_THAT(toldIn(1s), ElementsAre(Pair(7, ButtonLight{Active, "EDIT"}), Pair(9, ButtonLight{Ready, "LEFT"})));
    run.inputs.submit({run.clock.now(), show::Input::Kind::Go});
    EXPECT_THAT(toldIn(run.cues.cues[0].fade.in + 1s),
                ElementsAre(Pair(4, ButtonLight{Active, "GO"}), Pair(4, ButtonLight{Ready, "GO"})));
}

// The default site's, with a gate that starts the next cue and an emergency button, each the second
// contact of a bank of its own.
TEST(ContactsPart, a_gate_steps_the_cues_and_an_emergency_button_darkens_the_show) {
    RunningShow run;
    const show::DeviceConfig simulated{"simulated", valueOf(ConfigNode::parse("driver: simulated\n", "site.yaml"))};
    run.site.contactBanks = {{"doors", simulated}, {"desk", simulated}};
    run.site.contacts = {{"gate", 0, 1, show::ContactAction::Go, {}},
                         {"emergency", 1, 1, show::ContactAction::Dark, show::ContactAction::Light}};
    run.devices = valueOf(openDevices(run.site, Backends::SimulatedHeadless, {run.clock, &run.world}));
    show::PlaybackReplica lamps{run.inputs};
    Hand hand{run.played, run.inputs, run.site, run.devices, show::ShowClock(), run.events};
    const auto stateAfter = [&](const char* bank, bool closed) {
        run.world.setContact(bank, 1, closed);
        hand.tick(run.clock.now());
        for (const Time end = run.clock.now() + 2s; run.clock.now() < end; hand.tick(run.clock.now())) run.clock.advance(5ms);
        show::ShowState state;
        lamps.stateAt(run.clock.now(), state);
        return state;
    };
    hand.tick(run.clock.now());
    EXPECT_EQ(stateAfter("doors", true).cue, 0);
    EXPECT_EQ(stateAfter("doors", false).cue, 0);
    EXPECT_EQ(stateAfter("doors", true).cue, 1);
    EXPECT_TRUE(stateAfter("desk", true).blackout);
    EXPECT_FALSE(stateAfter("desk", false).blackout);
    for (const char* bank : {"doors", "desk"}) run.world.setPlugged(bank, false);
    EXPECT_FALSE(stateAfter("desk", true).blackout) << "nobody can know";
    EXPECT_EQ(stateAfter("doors", false).cue, 1);
    for (const char* bank : {"doors", "desk"}) run.world.setPlugged(bank, true);
    EXPECT_TRUE(stateAfter("doors", true).blackout) << "it was pressed meanwhile";
    EXPECT_EQ(stateAfter("doors", true).cue, 1) << "the gate moved while nobody saw it";
}

}  // namespace
}  // namespace fantascope::app
