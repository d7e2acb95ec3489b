// The schedule's cues come when the clock says so, whatever the clock and people do meanwhile.

#include "app/schedule/show_caller.h"

#include "app/schedule/outlook.h"

#include <gmock/gmock.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using show::Input;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Kind = Input::Kind;

// Two cues that follow each other for ever, every ten minutes, and one that waits.
show::CueList listOf() {
    show::CueList list;
    list.dark = {{}, {0.f}, {}};
    const auto cue = [&](const char* name, float level, std::optional<Time> follow) {
        list.cues.push_back({.look = {{}, {level}, {}}, .fade = 10s, .follow = follow, .name = name});
    };
    cue("Night", 1, 10min);
    cue("Storm", 0.5, 10min);
    list.loops = true;
    list.blackoutFade = 1s;
    list.darkFade = 5s;
    return list;
}

show::Schedule::Item itemOf(const char* from, const char* until) {
    const auto timeOf = [](const char* text) {
        return show::readNightTime(
                   ConfigNode::parse(std::string("at: \"") + text + "\"", "a").value().entries().value()[0].second)
            .value();
    };
    show::Schedule::Item item;
    item.from = timeOf(from);
    item.until = timeOf(until);
    return item;
}

show::Nights nightsOf(const show::Schedule& schedule) {
    return {schedule, {{0.8, 0.3, show::TimeZone::named("Europe/Vienna").value()}, {}}};
}

show::Nights nights() {
    show::Schedule schedule;
    schedule.items = {itemOf("20:00", "23:00")};
    return nightsOf(schedule);
}

class Calls : public testing::Test {
protected:
    Calls() {
        show::Revision revision{{}, {}, listOf(), nights_};
        revision.show.cues.resize(2);
        revision.show.cues[0].name = "Night";
        revision.show.cues[1].name = "Storm";
        show_.emplace(std::make_shared<const show::Revision>(std::move(revision)));
    }
    // 27 November 2026 by the clocks of Vienna; it is winter.
    static Time at(Time timeOfDay) { return std::chrono::sys_days(2026y / 11 / 27).time_since_epoch() + timeOfDay - 1h; }
    void begin(Time timeOfDay, std::optional<Time> followed = std::nullopt) {
        wall_.set(at(timeOfDay), 0s);
        caller_.emplace(*show_, inputs_, events_, wall_, show::ShowClock());
        caller_->begin(followed);
    }
    // Time goes on, at the wall and in the show.
    void pass(Time time) {
        for (const Time end = moment_ + time; moment_ < end;) {
            const Time step = std::min<Time>(250ms, end - moment_);
            moment_ += step;
            wall_.set(wall_.now().utc + step, 0s);
            caller_->tick(moment_);
        }
    }
    // The clock is set; the show's time goes on by a tick.
    void setClock(Time timeOfDay) {
        wall_.set(at(timeOfDay), 0s);
        caller_->tick(moment_ += 250ms);
    }
    void submit(Kind kind, int cue = 0) {
        inputs_.submit({.at = moment_, .kind = kind, .cue = cue, .source = Input::Source::Terminal});
    }
    const show::ShowState& state() {
        inputs_.foresee(moment_);
        replica_.stateAt(moment_, state_);
        return state_;
    }
    std::vector<std::string> told() {
        std::vector<std::string> lines;
        for (auto reader = events_.reader(); const show::Event* const event = reader.next();)
            if (!std::holds_alternative<show::event::NextDayTold>(event->what)) lines.push_back(show::sentenceOf(*event));
        return lines;
    }

    const show::Nights nights_ = nights();
    std::optional<show::PlayedShow> show_;
    show::InputLog inputs_{listOf()};
    show::EventLog events_;
    ManualWallClock wall_;
    std::optional<ShowCaller> caller_;
    show::PlaybackReplica replica_{inputs_};
    show::ShowState state_;
    Time moment_{};
};

TEST_F(Calls, a_cue_when_it_is_due_and_the_dark_at_its_end) {
    begin(19h + 59min);
    EXPECT_EQ(state().cue, -1);
    pass(59s);
    EXPECT_EQ(state().cue, -1);
    pass(2s);
    EXPECT_EQ(state().cue, 0);
    pass(3h - 2s);
    EXPECT_EQ(state().cue, 1) << "18 cues have followed";
    pass(3s);
    EXPECT_EQ(state().cue, -1);
    EXPECT_GT(state().levels[0], 0) << "it fades";
    pass(5s);
    EXPECT_EQ(state().levels[0], 0);
    EXPECT_THAT(told(), ElementsAre("schedule: 'Night' since 20:00", "schedule: dark since 23:00"));
    pass(13h);
    EXPECT_EQ(told().size(), 2u) << "nothing more until the evening";
    pass(8h);
    EXPECT_EQ(state().cue, 0);
}

// Example failure: the machine boots at 21:12 after a power cut, and the audience sees the night's
// beginning again.
TEST_F(Calls, a_late_machine_to_where_the_show_would_be) {
    begin(20h + 35min);
    EXPECT_EQ(state().cue, 1) << "Night, Storm, Night, and since 20:30 Storm";
    pass(2s);
    EXPECT_FLOAT_EQ(state().levels[0], 0.5f) << "its fade was over long ago, so it comes within a second";
    EXPECT_EQ(replica_.playback().untilFollowAt(moment_), 5min - 2s);
    EXPECT_THAT(told(), ElementsAre("schedule: 'Night' since 20:00, joined where the show would be"));
    pass(5min);
    EXPECT_EQ(state().cue, 0);
}

TEST_F(Calls, nobody_before_the_night_or_after_it) {
    begin(23h + 30min);
    pass(10min);
    EXPECT_EQ(state().cue, -1);
    EXPECT_THAT(told(), IsEmpty());
}

TEST_F(Calls, again_when_a_clock_that_was_wrong_is_set) {
    begin(3h);
    pass(1min);
    EXPECT_EQ(state().cue, -1);
    setClock(20h + 12min);
    EXPECT_EQ(state().cue, 1);
    EXPECT_THAT(told(), ElementsAre(HasSubstr("the machine's clock was set forward by 61860 s: Fri 27 Nov 2026, 20:12"),
                                    HasSubstr("'Night' since 20:00, joined")));
    setClock(15h);
    EXPECT_EQ(state().cue, -1) << "it is not evening yet";
    pass(5h + 1s);
    EXPECT_EQ(state().cue, 0);
}

// Example failure: at 20:00:00 the cue begins, the clock is set back by three seconds, and three
// seconds later the cue begins again.
TEST_F(Calls, no_cue_twice_when_the_clock_is_set_back_a_little) {
    begin(19h + 59min);
    pass(61s);
    EXPECT_EQ(state().cue, 0);
    setClock(19h + 58min);
    EXPECT_EQ(state().cue, 0);
    pass(3min);
    EXPECT_EQ(state().cue, 0);
    EXPECT_EQ(told().size(), 2u) << "one call, one clock";
    EXPECT_EQ(state().inputs, 1u);
}

TEST_F(Calls, leave_people_their_own_cue_until_the_next_moment) {
    begin(19h + 59min);
    submit(Kind::Go);
    submit(Kind::Freeze);
    pass(30s);
    EXPECT_EQ(state().cue, 0);
    pass(31s);
    submit(Kind::Jump, 1);
    pass(1min);
    EXPECT_EQ(state().cue, 1);
    pass(2h + 59min);
    EXPECT_EQ(state().cue, -1);
    EXPECT_FALSE(state().frozen) << "a freeze must not keep the light on all night";
    submit(Kind::Go);
    pass(13h);
    EXPECT_GE(state().cue, 0) << "whoever lights it after the end, or at noon, knows why";
}

TEST_F(Calls, wait_for_the_end_of_a_panic) {
    begin(19h + 59min);
    submit(Kind::Panic);
    pass(15min);
    EXPECT_EQ(state().cue, -1);
    EXPECT_THAT(told(), IsEmpty()) << "nothing is tried again and again";
    submit(Kind::Restore);
    pass(1s);
    EXPECT_EQ(state().cue, 1) << "since 20:10";
}

TEST_F(Calls, only_what_came_while_no_run_was_there) {
    inputs_.submit({.at = 0s, .kind = Kind::Jump, .cue = 1, .source = Input::Source::Terminal});
    begin(21h, at(20h + 30min));
    pass(1s);
    EXPECT_EQ(state().cue, 1) << "somebody wanted it";
    EXPECT_EQ(state().inputs, 1u);
    begin(23h + 1min, at(20h + 30min));
    EXPECT_EQ(state().cue, -1) << "it was to get dark meanwhile";
}

// A season's table is what is played: each cue of the two weeks in which the clocks go back.
TEST_F(Calls, what_the_table_of_the_season_says) {
    moment_ = 0s;
    wall_.set(std::chrono::sys_days(2026y / 10 / 18).time_since_epoch() + 10h, 0s);
    caller_.emplace(*show_, inputs_, events_, wall_, show::ShowClock());
    caller_->begin(std::nullopt);
    const Time began = wall_.now().utc;
    std::vector<show::Nights::Moment> played;
    for (bool lit = false; moment_ < 14 * 24h;) {
        moment_ += 5s;
        wall_.set(began + moment_, 0s);
        caller_->tick(moment_);
        if (const bool now = state().cue >= 0; std::exchange(lit, now) != now) played.push_back({began + moment_, now ? 0 : -1});
    }
    std::vector<show::Nights::Moment> planned = nights_.between(began, began + moment_);
    EXPECT_EQ(planned.size(), 28u);
    ASSERT_EQ(played.size(), planned.size());
    for (std::size_t i = 0; i < planned.size(); ++i) {
        EXPECT_EQ(played[i].cue, planned[i].cue);
        EXPECT_LT(std::chrono::abs(played[i].utc - planned[i].utc), 5s);
        EXPECT_EQ(show::clockOf(nights_.zone().at(planned[i].utc).timeOfDay), i % 2 == 0 ? "20:00" : "23:00");
    }
}

// A show whose cues have other places in the file, and another schedule.
// Example failures: the cue that is on begins again because its number has changed; a schedule that
// says dark since an hour leaves the light on.
TEST_F(Calls, go_on_when_the_show_is_revised) {
    begin(20h);
    pass(60s);
    const auto revise = [&](const char* until, const char* name) {
        show::CueList list = listOf();
        show::Revision revision{{}, {}, {}, {}};
        show::Schedule schedule;
        schedule.items = {itemOf("20:00", until)};
        schedule.items[0].cue = 1;
        revision.show.cues.resize(2);
        revision.show.cues[0].name = "Overture";
        revision.show.cues[1].name = name;
        std::swap(list.cues[0], list.cues[1]);
        list.cues[0].name = "Overture";
        list.cues[1].name = name;
        revision.cues = list;
        revision.nights = nightsOf(schedule);
        const auto shared = std::make_shared<const show::Revision>(std::move(revision));
        const int number = inputs_.add(show::Revision::cuesOf(shared));
        EXPECT_TRUE(show_->revise(shared, [&] {
            return inputs_.submit({.at = moment_, .kind = Kind::Revise, .revision = number}).outcome == show::Outcome::Taken;
        }));
    };
    const std::size_t calls = told().size();
    revise("23:00", "Night");
    pass(60s);
    EXPECT_EQ(state().cue, 1);
    EXPECT_EQ(told().size(), calls) << "nothing was called";
    revise("20:01", "Night");
    pass(10s);
    EXPECT_EQ(state().cue, -1);
    revise("23:00", "Finale");
    pass(10s);
    EXPECT_EQ(state().cue, 1) << "another cue is due now";
}

TEST_F(Calls, are_told_a_day_ahead) {
    begin(19h);
    EXPECT_EQ(caller_->nextDay(), "Fri 27 Nov 2026, 19:00 in Europe/Vienna: dark\n20:00  Night\n23:00  dark");
    Outlook outlook(*show_);
    EXPECT_EQ(outlook.at(at(19h)), "20:00 Night");
    EXPECT_EQ(outlook.at(at(20h)), "23:00 dark");
    EXPECT_EQ(outlook.at(at(19h)), "20:00 Night") << "the clock was set back";
    const show::PlayedShow unscheduled(std::make_shared<const show::Revision>(show::Revision{{}, {}, listOf(), {}}));
    EXPECT_EQ(Outlook(unscheduled).at(at(19h)), "");
    ShowCaller none(unscheduled, inputs_, events_, wall_, show::ShowClock());
    none.begin(std::nullopt);
    none.tick(1s);
    EXPECT_EQ(state().inputs, 0u);
}

}  // namespace
}  // namespace fantascope::app
