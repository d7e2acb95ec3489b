#include "app/live/run_view.h"

#include "app/running_show.h"

#include <gmock/gmock.h>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;

// The default show after three hours, of which this run has seen two seconds.
class View : public testing::Test {
protected:
    RunningShow run_;
    const show::ShowClock clock_{10s, 3h};
    RunView view_{run_.played, run_.inputs, run_.events, clock_, 60s};
};

TEST_F(View, counts_cues_in_show_time_and_what_is_left_in_run_time) {
    run_.inputs.submit({3h + 1s, show::Input::Kind::Go});
    const RunStatus status = view_.at(12s, 20s);
    EXPECT_EQ(status.showTime, 3h + 2s);
    EXPECT_EQ(status.controls.cue, 0);
    EXPECT_EQ(status.cueName, "Dusk");
    EXPECT_EQ(status.nextName, "First light");
    EXPECT_EQ(status.fadeLeft, run_.cues.cues[0].fade.in - 1s);
    EXPECT_EQ(status.left, 58s);
    EXPECT_EQ(status.untilNext, 18s) << "the schedule's press";
}

TEST_F(View, tells_the_first_cue_after_the_last_of_a_show_that_loops) {
    const int last = static_cast<int>(run_.cues.cues.size()) - 1;
    show::CueList loop = run_.cues;
    loop.loops = true;
    for (const bool loops : {false, true}) {
        show::InputLog inputs(loops ? loop : run_.cues);
        RunView view(run_.played, inputs, run_.events, clock_, 60s);
        inputs.submit({3h, show::Input::Kind::Jump, last});
        EXPECT_EQ(view.at(11s, Time::max()).nextName, loops ? "Dusk" : "");
    }
}

// Example failure: the terminal says that 'First light' comes in ten seconds, and the loop begins
// again.
TEST_F(View, tells_what_follows_and_what_go_would_enter) {
    show::CueList loop = run_.cues;
    loop.cues[0].follow = 10s;
    loop.cues[0].followers = {2};
    show::InputLog inputs(loop);
    RunView view(run_.played, inputs, run_.events, clock_, 60s);
    inputs.submit({3h + 1s, show::Input::Kind::Go});
    const RunStatus status = view.at(12s, Time::max());
    EXPECT_EQ(status.nextName, run_.show.cues[2].name);
    EXPECT_EQ(status.untilNext, 9s);
    EXPECT_EQ(status.loadedName, run_.show.cues[1].name) << "GO's";
}

// Example failure: the report has read a sentence, and the terminal never shows it.
TEST_F(View, says_what_happened_once_whoever_else_listens) {
    EXPECT_FALSE(view_.hasNews());
    run_.events.append({3h, show::event::HoldChanged{show::Hold::Blackout, true}});
    run_.events.append({3h, show::event::InputDecided{}});
    run_.events.append({3h, show::event::ScheduleEnded{}});
    EXPECT_EQ(run_.told().size(), 2u);
    EXPECT_TRUE(view_.hasNews());
    EXPECT_EQ(view_.at(12s, Time::max()).said, "blackout: pictures and lamps are dark; you have the controller");
    EXPECT_FALSE(view_.hasNews());
    EXPECT_EQ(view_.at(12s, Time::max()).said, "");
}

TEST(HowItIs, says_what_is_dark_and_why_and_what_is_not_well) {
    RunningShow run;
    const show::Revision& revision = run.played.at(0);
    show::ShowState state;
    state.outputs.resize(2);
    EXPECT_EQ(howItIs(state, revision, {}), "'left' is dark: no cue is on\n'right' is dark: no cue is on");
    state.cue = 0;
    state.outputs[0].layers = {{show::SourceId{0}, 1.0f}};
    EXPECT_EQ(howItIs(state, revision, {{2s, "dmx (sacn) is missing: no route", "dmx"}}),
              "'right' is dark: '" + revision.show.cues[0].name +
                  "' shows nothing there, or not yet\n"
                  "not well: dmx (sacn) is missing: no route");
    state.outputs[1] = state.outputs[0];
    EXPECT_EQ(howItIs(state, revision, {}), "every output shows something, and all is well");
    state.raised = {{0, 0.4f}};
    state.switched = {{1, true}};
    EXPECT_EQ(howItIs(state, revision, {}),
              "by hand: " + revision.site.fixtures[0].name + " 40 %, " + revision.site.relays[1].name + " on");
    state.raised.clear();
    state.switched.clear();
    state.solo = true;
    EXPECT_EQ(howItIs(state, revision, {}), "everything but one lamp is dark: SOLO");
    state.panic = state.blackout = true;
    EXPECT_EQ(howItIs(state, revision, {}), "everything is dark: PANIC");
    EXPECT_EQ(namesOf({{2s, "a", "left"}, {3s, "b", "left"}, {3s, "the journal: no room", ""}}), "left, the journal");
}

}  // namespace
}  // namespace fantascope::app
