#include "app/live/run_console.h"

#include <gmock/gmock.h>

#include <sstream>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

// In the third of six cues, four seconds before it is whole.
RunStatus fading() {
    RunStatus status;
    status.showTime = 12s;
    status.controls.cue = 2;
    status.cues = 6;
    status.number = 3000;
    status.cueName = "Left rises";
    status.nextName = "Both";
    status.fadeLeft = 4s;
    status.untilNext = 18s;
    status.left = 48s;
    status.keys = true;
    status.framesPerSecond = 30;
    status.zCamera = {{"left", 0.8124}, {"right", -1}};
    return status;
}

std::vector<std::string> at(const RunStatus& status, const std::vector<int>& columns) {
    std::vector<std::string> lines;
    for (const int width : columns) lines.push_back(statusLine(status, width));
    return lines;
}

const std::vector<int> kWidths = {40, 80, 120, 200};

TEST(StatusLine, says_what_is_on_what_comes_and_when) {
    EXPECT_EQ(
        statusLine(fading(), 200),
        "cue 3 of 6: Left rises  fading 4 s  next: Both in 18 s  48 s left  0 late  30.0 frames/s  z left 0.812  z right -");
}

TEST(StatusLine, says_a_number_that_is_not_the_place_what_waits_and_the_next_note) {
    RunStatus status = fading();
    status.number = 2500;
    status.waitLeft = 3s;
    status.nextNote = "after the bell";
    EXPECT_EQ(statusLine(status, 120),
              "cue 2.5 (3 of 6): Left rises  waits 3 s  next: Both in 18 s (after the bell)  48 s left  0 late  30.0 frames/s");
    EXPECT_EQ(statusLine(status, 80), "cue 2.5 (3 of 6): Left rises  waits 3 s  next: Both in 18 s  48 s left  0 late");
}

TEST(StatusLine, leaves_out_what_matters_least_where_it_is_narrow) {
    EXPECT_THAT(
        at(fading(), kWidths),
        testing::ElementsAre("3/6 Left rises  next: Both in 18 s",
                             "cue 3 of 6: Left rises  fading 4 s  next: Both in 18 s  48 s left  0 late",
                             "cue 3 of 6: Left rises  fading 4 s  next: Both in 18 s  48 s left  0 late  30.0 frames/s  z left "
                             "0.812  z right -",
                             "cue 3 of 6: Left rises  fading 4 s  next: Both in 18 s  48 s left  0 late  30.0 frames/s  z left "
                             "0.812  z right -"));
}

TEST(StatusLine, says_of_a_blackout_for_as_long_as_it_lasts_and_what_lifts_it) {
    RunStatus status = fading();
    status.controls.blackout = true;
    EXPECT_THAT(at(status, kWidths), testing::Each(StartsWith("BLACKOUT, 0 lifts it  ")));
    EXPECT_EQ(statusLine(status, 40), "BLACKOUT, 0 lifts it  3/6 Left rises");
    EXPECT_EQ(statusLine(status, 8), "BLACKOUT");
    status.keys = false;
    EXPECT_THAT(statusLine(status, 80), StartsWith("BLACKOUT  ")) << "nobody may press a key";
    status.keys = status.settingUp = true;
    EXPECT_THAT(statusLine(status, 80), StartsWith("BLACKOUT  SETTING UP, e ends it  ")) << "the key means something else now";
}

TEST(StatusLine, says_that_go_is_locked_and_what_unlocks_it) {
    RunStatus status = fading();
    status.controls.locked = true;
    EXPECT_THAT(statusLine(status, 200), StartsWith("LOCKED, l unlocks it  cue 3 of 6"));
    EXPECT_THAT(statusLine(status, 30), StartsWith("LOCKED  3/6"));
    status.keys = false;
    EXPECT_THAT(statusLine(status, 200), StartsWith("LOCKED  cue 3 of 6"));
}

TEST(StatusLine, says_what_the_operator_holds_and_how_to_let_it_go) {
    RunStatus status = fading();
    status.controls.panic = status.controls.frozen = status.controls.paused = true;
    status.controls.master = 0.7f;
    status.loadedName = "Storm";
    EXPECT_THAT(statusLine(status, 200), StartsWith("PANIC, r restores it  FROZEN, f ends it  PAUSED, p ends it  master 70 %  "
                                                    "cue 3 of 6: Left rises  fading 4 s  GO: Storm  next: Both"));
    EXPECT_EQ(statusLine(status, 60), "PANIC, r restores it  FROZEN  PAUSED  master 70 %  3/6");
    EXPECT_EQ(statusLine(status, 5), "PANIC") << "the last that is left out";
    status = fading();
    status.controls.master = 0;
    EXPECT_THAT(statusLine(status, 30), StartsWith("master 0 %")) << "it is dark, and this is why";
}

TEST(StatusLine, says_what_the_other_lists_do_and_which_one_has_the_keys) {
    RunStatus status = fading();
    status.zCamera.clear();
    status.framesPerSecond.reset();
    status.sides = {{.name = "Bar", .hasKeys = true, .cueName = "Warm", .nextName = "Cool", .untilNext = 90s}, {.name = "Lamps"}};
    EXPECT_EQ(statusLine(status, 200),
              "cue 3 of 6: Left rises  fading 4 s  next: Both in 18 s  [Bar]: Warm > Cool in 1:30 min  "
              "Lamps: dark  48 s left  0 late");
    EXPECT_THAT(statusLine(status, 100), HasSubstr("[Bar]: Warm  Lamps: dark"));
    EXPECT_THAT(statusLine(status, 30), HasSubstr("[Bar]")) << "GO does not do what it seems to do";
}

TEST(StatusLine, says_which_lamp_is_highlighted_or_alone_and_how_to_go_on) {
    RunStatus status = fading();
    status.highlighted = "gate";
    EXPECT_THAT(statusLine(status, 200), StartsWith("HIGHLIGHT gate, h goes on from it  cue 3 of 6"));
    status.controls.solo = true;
    EXPECT_THAT(statusLine(status, 200), StartsWith("SOLO gate, o ends it"));
    EXPECT_THAT(statusLine(status, 40), HasSubstr("SOLO gate"));
    status.controls.highlightLevel = 0.3f;
    status.parked = "stairs, well";
    status.byHand = "bench 40 %, fog on";
    EXPECT_THAT(statusLine(status, 200),
                StartsWith("SOLO gate at 30 %, o ends it  parked: stairs, well  by hand: bench 40 %, fog on"));
}

TEST(StatusLine, names_what_is_not_well_for_as_long_as_it_lasts) {
    RunStatus status = fading();
    EXPECT_THAT(statusLine(status, 200), Not(HasSubstr("NOT WELL")));
    status.unwell = "left, dmx";
    EXPECT_THAT(statusLine(status, 200), HasSubstr("NOT WELL: left, dmx"));
    EXPECT_THAT(statusLine(status, 60), HasSubstr("NOT WELL"));
}

TEST(StatusLine, before_the_first_cue_and_in_the_last) {
    RunStatus status;
    status.cues = 1;
    status.nextName = "Dusk";
    status.showTime = 3s;
    EXPECT_EQ(statusLine(status, 80), "no cue yet  next: Dusk  at 3 s  0 late");
    status.controls.cue = 0;
    status.number = 1000;
    status.cueName = "Dusk";
    status.nextName.clear();
    EXPECT_EQ(statusLine(status, 80), "cue 1 of 1: Dusk  last cue  at 3 s  0 late");
}

TEST(StatusLine, has_no_time_left_where_the_run_has_no_end) {
    RunStatus status = fading();
    status.left.reset();
    EXPECT_THAT(statusLine(status, 200), AllOf(Not(HasSubstr("left  ")), HasSubstr("  at 12 s  ")));
}

// Example failure: a name in Japanese wraps the line at half of what was thought, and each drawing
// scrolls the screen by one.
TEST(StatusLine, measures_names_in_columns) {
    RunStatus status = fading();
    status.cueName = "夜明けの光が左の壁に昇る";
    status.nextName = "Der Abschied von allen, die gekommen sind";
    EXPECT_THAT(at(status, {40, 60, 80}),
                testing::ElementsAre("3/6 夜明けの光が左…  next in 18 s", "3/6 夜明けの光が左…  next: Der Abschied vo… in 18 s",
                                     "3/6 夜明けの光が左…  fading 4 s  next: Der Abschied vo… in 18 s  48 s left"));
    for (int columns = 0; columns < 200; ++columns) EXPECT_LE(columnsOf(statusLine(status, columns)), columns);
}

// A journal keeps every line for months.
TEST(RunConsole, away_from_a_terminal_tells_news_and_a_line_a_minute) {
    ManualClock clock;
    std::ostringstream out;
    RunConsole console(clock, out, {});
    RunStatus status = fading();
    status.left.reset();
    for (int half = 0; half < 240; ++half, clock.advance(500ms)) {
        status.said = half == 30 ? "cue 4 of 6: Both" : "";
        console.tell(status);
    }
    const std::string line = "  12.0 s  " + statusLine(status, 1000) + "\n";
    EXPECT_EQ(out.str(), line + "  12.0 s  cue 4 of 6: Both\n" + line);
}

TEST(RunConsole, on_a_terminal_is_one_line_with_the_news_above) {
    ManualClock clock;
    std::ostringstream out;
    {
        RunConsole console(clock, out, [] { return 41; });
        RunStatus status = fading();
        console.tell(status);
        clock.advance(500ms);
        status.said = "you have the controller";
        console.tell(status);
    }
    EXPECT_EQ(out.str(),
              "\r\x1b[J3/6 Left rises  next: Both in 18 s\r"
              "\r\x1b[J  12.0 s  you have the controller\n"
              "\r\x1b[J3/6 Left rises  next: Both in 18 s\r\n");
}

// Example failure: a cue's name clears the operator's screen.
TEST(RunConsole, prints_nothing_that_a_terminal_would_obey) {
    const ManualClock clock;
    std::ostringstream out;
    RunStatus status;
    status.said = "cue 1 of 1: \x1b[2J";
    RunConsole(clock, out, {}).tell(status);
    EXPECT_THAT(out.str(), AllOf(HasSubstr("cue 1 of 1: ?[2J\n"), Not(HasSubstr("\x1b"))));
}

TEST(RunConsole, gives_each_line_of_the_news_a_line) {
    const ManualClock clock;
    std::ostringstream out;
    RunStatus status;
    status.said = "the keys:\n  b  back\n  q  end\n";
    RunConsole(clock, out, {}).tell(status);
    EXPECT_THAT(out.str(), StartsWith("   0.0 s  the keys:\n            b  back\n            q  end\n"));
}

// An alarm that is none teaches not to look.
TEST(RunSummary, speaks_of_the_machine_only_where_that_made_frames_late) {
    RunReport report;
    report.length = 60s;
    report.cues.resize(6);
    report.yardstickTicks = 1800;
    report.yardstickLate = 4;
    EXPECT_EQ(summaryOf(report), "60.0 s, 6 cues entered, no frame shown");
    report.outputs = {OutputReport{.name = "left", .frames = 1800}};
    EXPECT_EQ(summaryOf(report), "60.0 s, 6 cues entered, 1800 frames shown, none late");
    report.outputs[0].lateBy[static_cast<std::size_t>(FramePart::Render)] = 3;
    EXPECT_EQ(summaryOf(report), "60.0 s, 6 cues entered, 1800 frames shown, 3 late: 3 render");
    report.outputs[0].lateByMachine = 2;
    EXPECT_THAT(
        summaryOf(report),
        HasSubstr("5 late: 3 render, 2 machine; the machine was too busy even for a thread that does nothing, 4 times in 1800"));
}

}  // namespace
}  // namespace fantascope::app
