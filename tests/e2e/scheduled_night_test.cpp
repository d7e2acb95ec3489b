// Nights by the schedule, with nobody there: what the table says is what is played.

#include "program.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

namespace fantascope {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

constexpr const char* kShow = R"(fantascope: show
version: 2
title: Nights
start: schedule
schedule:
  nights:
    - {cue: Red, from: "20:00", until: "20:06"}
    - {cue: Bells, from: "20:04", on: [sat]}
sources: {red: {solid: [1, 0, 0]}}
looks: {red: {outputs: {wall: [{source: red}]}}, off: {outputs: {wall: []}}}
cues:
  - {name: Red, look: red, fade: 1, follow: 50}
  - {name: Off, look: off, fade: 1, follow: {after: 50, to: Red}}
  - {name: Bells, look: red, fade: 1}
)";

constexpr const char* kSite = R"(fantascope: site
version: 1
outputs:
  - {name: wall, display: {driver: headless}, size: [64, 36], refresh_rate: 5,
     projector: {position: [0, 2, 8], look_at: [0, 1, 0], throw_ratio: 1.5}}
place: {latitude: 48.2, longitude: 16.4, time_zone: Europe/Vienna}
simulation:
  objects: [{name: wall, rectangle: {corner: [-9, 0, 0], right: [18, 0, 0], up: [0, 5, 0]}}]
  projectors: {wall: {lumens: 3000}}
)";

class ScheduledNight : public testing::Test {
protected:
    ScheduledNight() {
        folder_.file("show.yaml", kShow);
        folder_.file("site.yaml", kSite);
    }
    Outcome run(const std::vector<std::string>& arguments) { return runProgram(arguments, folder_.path()); }
    // The cues of a rehearsal that begins at a moment, and when they were entered, in seconds.
    std::vector<std::pair<std::string, double>> playedFrom(const std::string& at, const std::string& length) {
        const Outcome outcome =
            run({"rehearse", ".", "--site", ".", "--at", at, "--seconds", length, "--as-fast-as-possible", "--report", "r.json"});
        EXPECT_THAT(outcome, exits(0));
        said_ = outcome.errors;
        std::vector<std::pair<std::string, double>> cues;
        const json report = json::parse(contentsOf(folder_ / "r.json"));
        for (const json& cue : report["cues"]) cues.emplace_back(cue["name"], cue["entered"]);
        return cues;
    }
    static auto entered(const std::string& cue, double at) { return Pair(cue, testing::DoubleNear(at, 0.3)); }

    const ScratchFolder folder_;
    std::string said_;
};

TEST_F(ScheduledNight, plays_what_its_table_says) {
    ASSERT_THAT(run({"schedule", ".", "--site", ".", "--from", "2026-12-04", "--days", "2", "--report", "s.json"}), exits(0));
    const json nights = json::parse(contentsOf(folder_ / "s.json"))["nights"];
    ASSERT_EQ(nights.size(), 2u);
    EXPECT_EQ(nights[1]["date"], "2026-12-05");
    const double began = nights[0]["cues"][0]["from"].get<double>() - 60;
    EXPECT_EQ(nights[0]["cues"][0]["until"].get<double>() - began, 7 * 60);
    EXPECT_THAT(playedFrom("2026-12-04 19:59", "480"), ElementsAre(entered("Red", 60), entered("Off", 110), entered("Red", 160),
                                                                   entered("Off", 210), entered("Red", 260), entered("Off", 310),
                                                                   entered("Red", 360), entered("Off", 410), entered("", 420)));
    EXPECT_THAT(said_, HasSubstr("20:00  Red\n"));
    // On a Saturday the bells come in between, and nothing ends them before noon.
    EXPECT_EQ(nights[1]["cues"][1]["cue"], "Bells");
    EXPECT_THAT(playedFrom("2026-12-05 20:03", "300"), ElementsAre(entered("Off", 0), entered("Red", 20), entered("Bells", 60)));
}

// FANTASCOPE_NIGHT=28800 plays eight hours twice.
// Example failure: the machine's own clock gets into a journal.
TEST_F(ScheduledNight, leaves_the_same_journal_each_time) {
    const char* const wanted = std::getenv("FANTASCOPE_NIGHT");
    const std::string length = wanted != nullptr ? wanted : "400";
    for (const char* const journal : {"one", "two"})
        ASSERT_THAT(run({"rehearse", ".", "--site", ".", "--at", "2026-12-04 19:59", "--seconds", length, "--as-fast-as-possible",
                         "--journal", journal}),
                    exits(0));
    const std::string journal = contentsOf(folder_ / "one" / "journal");
    EXPECT_THAT(journal, HasSubstr("cue 1 of 3: Red"));
    EXPECT_TRUE(journal == contentsOf(folder_ / "two" / "journal"));
}

// A machine that boots in the middle of a night, with nobody to press anything.
TEST_F(ScheduledNight, is_joined_where_it_would_be) {
    EXPECT_THAT(playedFrom("2026-12-04 20:03", "65"), ElementsAre(entered("Off", 0), entered("Red", 20)));
    EXPECT_THAT(said_, HasSubstr("schedule: 'Red' since 20:00, joined where the show would be"));
    EXPECT_THAT(playedFrom("2026-12-04 20:06", "10"), ElementsAre());
}

}  // namespace
}  // namespace fantascope
