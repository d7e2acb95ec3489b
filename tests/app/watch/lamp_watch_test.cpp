// The watch of the other light on the pictures, on a street of formulas.

#include "app/watch/lamp_watch.h"

#include "show/cue_list.h"
#include "show/play/playback.h"

#include "core/random.h"

#include <gmock/gmock.h>

#include <array>
#include <string>
#include <variant>
#include <vector>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Mode = show::Corrections::Mode;

constexpr double kLamp = 0.1;  // light of the spot at full level, of full light

show::Site streetWith(Mode mode) {
    show::Site site;
    site.outputs.resize(1);
    site.fixtures = {{"spot", 1, 1, {"intensity"}}, {"sign", 2, 1, {"intensity"}}};
    site.corrections.lamps.mode = mode;
    site.corrections.lamps.fixtures = {0};
    site.corrections.lamps.speed = 0.05;
    return site;
}

show::CueList oneCue() {
    show::CueList list;
    list.dark = {{{}}, {0, 0}, {}};
    list.cues = {{{{{}}, {1, 1}, {}}, 0s, std::nullopt, {}, "One"}};
    list.trim = {0.3f, 0.05, 0, 1min};
    return list;
}

// A spot on one picture, and ambient light. The camera measures four times in three seconds.
struct Street {
    explicit Street(Mode mode) : site(streetWith(mode)) {
        inputs.submit({.at = 0s, .kind = show::Input::Kind::Go});
        play(20);
    }
    void play(double length) {
        for (const Time end = now + fromSeconds(length); now < end; now += 250ms) {
            while (const show::LoggedInput* input = logged.next()) playback.apply(input->input);
            playback.stateAt(now, state);
            watch.note(state);
            if (++ticks % 3 == 0) {
                vision::WallLight light;
                light.outputs.resize(1);
                light.outputs[0].emplace().allOtherLight =
                    0.02 + ambient + kLamp * state.levels[0] * state.lamps.share + 0.001 * (2 * rng.uniform() - 1);
                watch.see(light, isClear, now, now);
            }
            watch.tick(now);
        }
    }
    void press(show::Input::Kind kind) { inputs.submit({.at = now, .kind = kind}); }
    void send(int universe, const std::vector<std::string>& senders) {
        events.append({now, show::event::SendersChanged{universe, senders}});
    }
    float share() const { return state.lamps.share; }
    std::vector<std::string> told() const {
        std::vector<std::string> told;
        auto reader = events.reader();
        while (const show::Event* event = reader.next())
            if (std::holds_alternative<show::event::LampsTrimmed>(event->what)) told.push_back(sentenceOf(*event));
        return told;
    }

    show::Site site;
    show::InputLog inputs{oneCue()};
    show::InputLog::Reader logged = inputs.reader();
    show::Playback playback{oneCue()};
    show::EventLog events;
    LampWatch watch{site, inputs, events};
    show::ShowState state;
    Time now{};
    int ticks = 0;
    double ambient = 0;
    bool isClear = true;
    Rng rng{5};
};

TEST(LampWatch, dims_for_ambient_light_and_gives_all_back) {
    Street street(Mode::Automatic);
    EXPECT_EQ(street.share(), 1);
    street.ambient = 0.04;
    street.play(90);
    EXPECT_NEAR(street.share(), 0.6, 0.07);
    EXPECT_THAT(street.told().front(), HasSubstr("the lamps go to"));
    street.ambient = 0;
    street.play(60);
    EXPECT_EQ(street.share(), 1);
    EXPECT_THAT(street.told().back(), HasSubstr("the lamps go back"));
}

// Example failure: the street stays dark because the camera has failed.
TEST(LampWatch, keeps_a_trim_for_three_minutes_without_a_measurement_and_no_longer) {
    Street street(Mode::Automatic);
    street.ambient = 0.04;
    street.play(90);
    const float share = street.share();
    ASSERT_LT(share, 0.8f);
    street.isClear = false;
    street.play(175);
    EXPECT_EQ(street.share(), share);
    street.play(30);
    EXPECT_EQ(street.share(), 1);
    EXPECT_THAT(street.told().back(), HasSubstr("three minutes"));
}

// Example failure: a desk's lamps count as ambient light.
TEST(LampWatch, trims_nothing_while_a_desk_sends_to_its_lamps) {
    Street street(Mode::Automatic);
    street.send(1, {"", "desk"});
    street.ambient = 0.04;
    street.play(90);
    EXPECT_EQ(street.share(), 1);
    street.send(3, {"", "desk"});
    street.send(1, {""});
    street.play(30);
    EXPECT_EQ(street.share(), 1) << "what the desk left is usual";
    street.ambient = 0.08;
    street.play(90);
    EXPECT_NEAR(street.share(), 0.6, 0.07) << "the other universe has no lamps";
}

TEST(LampWatch, does_nothing_that_the_operator_has_taken_back_or_in_the_dark) {
    for (const auto kind : {show::Input::Kind::Corrections, show::Input::Kind::Dark}) {
        Street street(Mode::Automatic);
        street.press(kind);
        street.ambient = 0.04;
        street.play(90);
        EXPECT_EQ(street.share(), 1);
        EXPECT_THAT(street.told(), IsEmpty());
    }
}

TEST(LampWatch, says_once_what_it_would_do_where_it_only_advises) {
    Street street(Mode::Advise);
    street.ambient = 0.04;
    street.play(200);
    EXPECT_EQ(street.share(), 1);
    EXPECT_THAT(street.told(), ElementsAre(HasSubstr("the lamps could give less")));
}

}  // namespace
}  // namespace fantascope::app
