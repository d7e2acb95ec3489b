// What a journal says of its night, and the page that tells it.

#include "app/journal/night.h"

#include "core/file.h"
#include "program.h"
#include "scratch_folder.h"

#include <gmock/gmock.h>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
namespace journal = show::journal;
using Kind = show::Input::Kind;
using Source = show::Input::Source;

constexpr Time kEvening = 1'700'000'000s;

journal::State stateOf(Time at, int cue, const std::string& name) {
    journal::State state{.at = at, .controls = {}, .corrects = true, .cue = name};
    state.controls.cue = cue;
    return state;
}

// A night of two runs: the first died in a blackout, the second ended in order.
std::string text() {
    std::string text(show::kJournalHead);
    const auto add = [&](const journal::Line& line) { text += show::lineOf(line); };
    add(journal::Run{0s, kEvening, false, 1, "shows/<b>storm"});
    add(show::Input{.at = 1s, .kind = Kind::Go, .source = Source::Controller, .which = 3});
    add(stateOf(1s, 0, "Dusk & dawn"));
    add(show::Input{.at = 5s, .kind = Kind::Correct, .source = Source::Camera});
    add(journal::Figures{60s, 1800, 4, {{"left", 0.25}, {"right", -1}}});
    add(show::Input{.at = 70s, .kind = Kind::Dark, .source = Source::Contact, .which = 1});
    auto dark = stateOf(70s, 0, "Dusk & dawn");
    dark.controls.blackout = true;
    add(dark);
    add(journal::Told{80s, "'<left>' is missing"});
    add(journal::Run{100s, kEvening + 400s, true, 1, "shows/<b>storm"});
    dark.at = 100s;
    add(dark);
    add(show::Input{.at = 110s, .kind = Kind::Light, .source = Source::Terminal});
    add(stateOf(110s, 0, "Dusk & dawn"));
    show::Input jump{.at = 120s, .kind = Kind::Jump, .cue = 4, .source = Source::Terminal};
    add(jump);
    add(stateOf(120s, 4, "Full"));
    add(journal::Gap{});
    add(journal::Figures{150s, 1500, 2, {{"left", 0.5}}});
    add(journal::End{160s, "length"});
    return text;
}

Night night() { return nightOf(show::journalOf(text()).value()); }

TEST(NightSummary, is_what_its_journal_says) {
    const Night told = night();
    ASSERT_EQ(told.runs.size(), 2u);
    EXPECT_EQ(told.deaths(), 1u);
    EXPECT_EQ(told.runs[0].to, 100s) << "it was alive until the next one went on";
    EXPECT_EQ(told.runs[1].ended, "length");
    EXPECT_EQ(told.length(), 160s);
    EXPECT_THAT(told.cues, ElementsAre(Night::Stretch{1s, 120s, "Dusk & dawn"}, Night::Stretch{120s, 160s, "Full"}));
    EXPECT_THAT(told.holds, ElementsAre(Night::Stretch{70s, 110s, "blackout"}));
    ASSERT_EQ(told.presses.size(), 4u);
    EXPECT_EQ(told.presses[0].by, "controller 3");
    EXPECT_EQ(told.presses[3].what, "jump 5") << "cues count from 1 for people";
    EXPECT_EQ(told.corrections, 1u);
    EXPECT_EQ(told.frames, 3300);
    EXPECT_EQ(told.late, 6) << "each run counts from its own beginning";
    EXPECT_EQ(told.z.at("left").size(), 2u);
    EXPECT_EQ(told.z.count("right"), 0u) << "it has no score";
    EXPECT_EQ(told.gaps, 1u);
    EXPECT_EQ(told.wallTimeOf(110s).utc, kEvening + 410s) << "the time between the runs does not count";
}

TEST(NightSummary, of_an_empty_journal_is_empty) {
    const Night told = nightOf(show::journalOf(show::kJournalHead).value());
    EXPECT_EQ(told.length(), 0s);
    EXPECT_THAT(pageOf({{"journal", told}}), HasSubstr("</html>"));
}

// Example failure: a cue is called "<b>", and the rest of the page is bold.
TEST(NightPage, tells_names_as_they_are) {
    const std::string page = pageOf({{"nights/journal", night()}});
    EXPECT_THAT(page, AllOf(HasSubstr("Dusk &amp; dawn"), HasSubstr("'&lt;left&gt;' is missing"),
                            HasSubstr("shows/&lt;b&gt;storm"), Not(HasSubstr("<b>")), Not(HasSubstr("http"))));
}

TEST(NightPage, is_written_of_a_folder_and_of_single_journals) {
    const ScratchFolder folder;
    folder.file("nights/journal", text());
    folder.file("nights/journal-20231114T221320", text());
    folder.file("nights/clock", "");
    const auto all = runProgram({"report", "nights", "-o", "page.html"}, folder.path());
    EXPECT_EQ(all.status, 0) << all.errors;
    EXPECT_THAT(all.out, HasSubstr("page.html: 2 nights, 2 of the runs died, 2 lines are lost"));
    EXPECT_THAT(*readFile(folder / "page.html"), HasSubstr("<h1>2 nights</h1>"));
    EXPECT_EQ(runProgram({"report", "nights/journal", "-o", "one.html"}, folder.path()).status, 0);
    EXPECT_THAT(runProgram({"report", ".", "-o", "none.html"}, folder.path()).errors, HasSubstr("it holds no journal"));
    EXPECT_THAT(runProgram({"report", "nights", "-o", "page.txt"}, folder.path()).errors, HasSubstr("ends in .html"));
}

}  // namespace
}  // namespace fantascope::app
