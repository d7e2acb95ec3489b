// One stream of what happens, and everybody who listens hears all of it.

#include "show/play/event.h"

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;

std::vector<std::string> heard(EventLog::Reader& reader) {
    std::vector<std::string> sentences;
    while (const Event* const event = reader.next()) sentences.push_back(sentenceOf(*event));
    return sentences;
}

// Example failure: the console takes the news, and the terminal never hears of it.
TEST(Events, are_heard_by_every_listener_whenever_it_listens) {
    EventLog events;
    auto terminal = events.reader(), console = events.reader();
    events.append({1s, event::CueEntered{0, 3, "Dusk", 1000}});
    EXPECT_THAT(heard(terminal), ElementsAre("cue 1 of 3: Dusk"));
    events.append({2s, event::HoldChanged{Hold::Blackout, true}});
    EXPECT_THAT(heard(console), ElementsAre("cue 1 of 3: Dusk", "blackout: pictures and lamps are dark"));
    EXPECT_THAT(heard(terminal), ElementsAre("blackout: pictures and lamps are dark"));
    EXPECT_THAT(heard(terminal), ElementsAre());
    auto late = events.reader();
    EXPECT_EQ(late.next()->at, 1s);
}

TEST(Events, say_one_sentence_each) {
    const auto said = [](const event::What& what) { return sentenceOf(Event{{}, what}); };
    EXPECT_EQ(said(event::InputDecided{{0, {}, Outcome::AtLastCue}}), "ignored: this is the last cue");
    EXPECT_EQ(said(event::CueEntered{2, 7, "Dusk", 2500}), "cue 2.5 (3 of 7): Dusk");
    EXPECT_EQ(said(event::HoldChanged{Hold::Lock, true}), "locked: hand controller, contacts and windows can only make it dark");
    EXPECT_EQ(said(event::HoldChanged{Hold::Blackout, false}), "light: the blackout is over");
    EXPECT_EQ(said(event::ScheduleEnded{}), "you have the controller");
    EXPECT_EQ(said(event::QuitAsked{"q", 3s}), "the show goes on; q again within 3 s ends it");
    EXPECT_EQ(said(event::FaultBegan{"road", "'road' is missing"}), "'road' is missing");
    EXPECT_EQ(said(event::FaultEnded{"road", "'road' is back", 3200ms}), "'road' is back after 3.2 s");
    EXPECT_EQ(said(event::FaultEnded{"road", "'road' is back", 125s}), "'road' is back after 2 min 05 s");
    EXPECT_EQ(said(event::FaultEnded{"road", "'road' is back", 59960ms}), "'road' is back after 1 min 00 s");
    EXPECT_EQ(said(event::FaultEnded{"road", "'road' is back", 119700ms}), "'road' is back after 1 min 59 s");
    EXPECT_EQ(said(event::SendersChanged{1, {"", "FOH"}}), "universe 1 is now sent by the show and 'FOH'");
    EXPECT_EQ(said(event::PictureTaken{"pictures/a.png"}), "picture: pictures/a.png");
    EXPECT_EQ(said(event::PictureMissed{"'left' shows nothing"}), "no picture: 'left' shows nothing");
    EXPECT_EQ(said(event::PictureMoved{"left", 20.96}), "the picture of 'left' has moved by 21.0 px on the wall");
    EXPECT_EQ(said(event::LampsTrimmed{"there is more light", 0.6, {"path", "road"}, true}),
              "there is more light: the lamps go to 60 % of their levels; off: path, road; c takes it back");
    EXPECT_EQ(said(event::LampsTrimmed{"there is less light", 1, {}, true}),
              "there is less light: the lamps go back to what the cue asks");
    EXPECT_EQ(said(event::LampsTrimmed{"there is more light", 1, {}, false}),
              "there is more light: the lamps could give less (corrections: lamps: {mode: automatic} in the site file)");
    EXPECT_THAT(said(event::CameraMoved{}), testing::HasSubstr("calibrate again"));
    EXPECT_THAT(said(event::MovementUnclear{}), testing::HasSubstr("look at both"));
    EXPECT_EQ(said(event::LightCorrected{"wall", 0.46, 0.081, 0.02, true, ""}),
              "the light of 'wall' is evened out: 46 % of its light is left; 8 % of its places stay darker and 2 % brighter than "
              "the others");
    EXPECT_EQ(said(event::LightCorrected{"wall", 0.46, 0.081, 0.02, false, ""}),
              "the light of 'wall' could be evened out (corrections: light: {mode: automatic} in the site file): 46 % of its "
              "light would be left; 8 % of its places stay darker and 2 % brighter than the others");
    EXPECT_EQ(said(event::LightCorrected{"wall", 1, 0, 0, true, "it was not surveyed"}),
              "the light of 'wall' is not evened out: it was not surveyed");
    EXPECT_EQ(said(event::PatternFitted{"leaves", 0.05, 0.031, 0.9, 12, 3, 20, false}),
              "leaves: the pattern would read 38 % better on this wall (corrections: pattern: {mode: automatic})");
    EXPECT_EQ(said(event::PatternFitted{"leaves", 0.05, 0.031, 0.9, 12, 3, 20, true}),
              "leaves: the pattern is fitted to this wall and reads 38 % better: 12 shapes come, 3 go, 20 change");
    EXPECT_EQ(said(event::SettingUpBegan{}), "setting up the outputs: the picture lists the keys, e ends it");
    EXPECT_EQ(said(event::SettingUpEnded{true}), "the outputs are set up");
    EXPECT_EQ(said(event::SettingUpEnded{false}), "the outputs are set up but not written to the file: e, then w");
    EXPECT_EQ(said(event::SiteSaved{"site.yaml", "site.yaml.previous"}),
              "site.yaml is written; its previous version is site.yaml.previous");
    EXPECT_EQ(said(event::SiteNotSaved{"the disk is full"}), "not written: the disk is full");
}

// Example failure: the operator reads "taken" with every press, and misses what matters.
TEST(Events, of_which_nobody_needs_to_be_told_say_nothing) {
    const auto said = [](const event::What& what) { return sentenceOf(Event{{}, what}); };
    EXPECT_EQ(said(event::InputDecided{{0, {}, Outcome::Taken}}), "");
    EXPECT_EQ(said(event::FaultEnded{"universe 1", "", 3s}), "");
    EXPECT_EQ(said(event::SendersChanged{1, {"FOH", ""}}), "") << "the fault says it";
}

}  // namespace
}  // namespace fantascope::show
