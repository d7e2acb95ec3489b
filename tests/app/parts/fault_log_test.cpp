#include "app/parts/fault_log.h"

#include "app/running_show.h"

#include <gmock/gmock.h>

#include <sstream>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::SizeIs;

using Topic = FaultLog::Topic;

class Faults : public testing::Test {
protected:
    // "2-5 road: it is gone", "7- ..." of one that lasts.
    std::vector<std::string> reported() const {
        std::vector<std::string> texts;
        for (const FaultReport& fault : log_.faults()) {
            std::ostringstream text;
            text << seconds(fault.at) << '-';
            if (fault.until) text << seconds(*fault.until);
            text << ' ' << fault.device << ": " << fault.what;
            texts.push_back(text.str());
        }
        return texts;
    }

    std::vector<std::string> told() const { return toldOf(events_); }

    show::EventLog events_;
    FaultLog log_{events_};
};

TEST_F(Faults, are_told_once_and_kept_with_their_end) {
    for (const Time at : {1s, 2s, 3s}) log_.raise(at, "road", Topic::Missing, "it is gone");
    for (const Time at : {4s, 5s}) log_.clear(at, "road", Topic::Missing, "it is back");
    EXPECT_THAT(told(), ElementsAre("it is gone", "it is back after 3.0 s"));
    EXPECT_THAT(reported(), ElementsAre("1-4 road: it is gone"));
}

TEST_F(Faults, are_told_again_when_they_change) {
    log_.raise(1s, "road", Topic::Missing, "unplugged");
    log_.raise(80s, "road", Topic::Missing, "no right to open it");
    log_.clear(200s, "road", Topic::Missing, "it is back");
    EXPECT_THAT(told(), ElementsAre("unplugged", "no right to open it", "it is back after 2 min 00 s"));
    EXPECT_THAT(reported(), ElementsAre("1-80 road: unplugged", "80-200 road: no right to open it"));
}

TEST_F(Faults, of_one_device_do_not_hide_each_other) {
    log_.raise(1s, "road", Topic::Missing, "it is gone");
    log_.raise(2s, "road", Topic::Relays, "a relay sticks");
    log_.clear(3s, "road", Topic::Missing, "");
    log_.clear(4s, "park", Topic::Missing, "it is back");
    EXPECT_THAT(reported(), ElementsAre("1-3 road: it is gone", "2- road: a relay sticks"));
    EXPECT_THAT(told(), SizeIs(2));
}

// Example failure: a loose plug fills the terminal and the report all night.
TEST_F(Faults, that_come_and_go_are_told_as_such_until_they_were_steady) {
    for (int time = 0; time < 300; ++time) {
        log_.raise(time * 100ms, "road", Topic::Missing, "it is gone");
        log_.clear(time * 100ms + 50ms, "road", Topic::Missing, "it is back");
    }
    EXPECT_THAT(told(), SizeIs(2 * FaultLog::kBurst + 1)) << "so often gone and back, and that it comes and goes";
    EXPECT_EQ(told().back(), "it is gone; it comes and goes");
    for (int second = 30; second < 50; ++second) log_.clear(second * 1s, "road", Topic::Missing, "it is back");
    ASSERT_THAT(reported(), SizeIs(FaultLog::kBurst));
    EXPECT_EQ(reported().back(), "0.9-29.9 road: it is gone; it comes and goes");
    EXPECT_EQ(told().back(), "it is back after 29.0 s");
    log_.raise(100s, "road", Topic::Missing, "it is gone");
    EXPECT_EQ(told().back(), "it is gone") << "that is another time";
}

// How long something fails is a person's time, also while the show stands still; when it failed is
// the show's.
TEST_F(Faults, are_reported_in_show_time_and_last_in_the_machines) {
    show::ShowClock clock(10s, 3h);
    clock.pause(20s);
    log_.begin(clock);
    log_.raise(15s, "road", Topic::Missing, "it is gone");
    log_.clear(50s, "road", Topic::Missing, "it is back");
    EXPECT_THAT(told(), ElementsAre("it is gone", "it is back after 35.0 s"));
    EXPECT_THAT(reported(), ElementsAre("10805-10810 road: it is gone"));
    EXPECT_EQ(events_.reader().next()->at, 3h + 5s);
}

class WatchOfDevices : public Faults {
protected:
    void look(Time at, DeviceState state, int losses, const std::string& detail = "") {
        watch_.look(at, std::vector{DeviceStatus{"universe 1", "sacn", state, LossAction::Hold, detail, losses}});
    }
    DeviceWatch watch_{log_, {"road"}, 0s};
};

TEST_F(WatchOfDevices, reports_one_that_is_missing_at_the_start_and_when_it_comes) {
    look(0s, DeviceState::Starting, 0, "looking for it");
    look(1s, DeviceState::Absent, 0, "there is no eth7");
    look(2s, DeviceState::Starting, 0, "looking for it");
    look(3s, DeviceState::Running, 0);
    EXPECT_THAT(told(), ElementsAre("universe 1 (sacn) is missing: there is no eth7", "universe 1 (sacn) is back after 2.0 s"));
    EXPECT_THAT(reported(), ElementsAre("1-3 universe 1: universe 1 (sacn) is missing: there is no eth7"));
}

// Example failure: a bus that hangs while it is opened is starting all night, and nobody is told.
TEST_F(WatchOfDevices, reports_one_that_does_not_get_beyond_its_start) {
    look(1s, DeviceState::Starting, 0, "looking for it");
    EXPECT_TRUE(told().empty());
    look(DeviceWatch::kPatience, DeviceState::Starting, 0, "looking for it");
    EXPECT_THAT(told(), ElementsAre("universe 1 (sacn) is missing: looking for it"));
}

// Example failure: every device of a show that is resumed after three hours is missing at once,
// because its patience counts from the show's beginning.
TEST_F(Faults, of_a_start_are_waited_for_from_the_runs_start) {
    log_.begin(show::ShowClock(50s, 3h));
    DeviceWatch watch(log_, {}, 50s);
    const std::vector<DeviceStatus> starting{{"left", "glfw", DeviceState::Starting, LossAction::Dark, "looking for it", 0}};
    watch.look(50s + DeviceWatch::kPatience - 1ns, starting);
    EXPECT_TRUE(told().empty());
    watch.look(50s + DeviceWatch::kPatience, starting);
    EXPECT_THAT(told(), SizeIs(1));
}

// Example failure: a cable that is pulled and put back between two looks leaves no trace.
TEST_F(WatchOfDevices, reports_a_loss_that_is_over_before_it_looked) {
    look(0s, DeviceState::Running, 0);
    look(1s, DeviceState::Running, 1);
    look(2s, DeviceState::Running, 1);
    EXPECT_THAT(reported(), ElementsAre("1-2 universe 1: universe 1 (sacn) was lost for a moment"));
}

// Example failure: a hand controller whose lights have failed is dark all night, and the report
// says that nothing was wrong.
TEST_F(WatchOfDevices, reports_what_a_device_does_not_do_although_it_is_there) {
    DeviceStatus status{"cue controller", "usb_hid", DeviceState::Running, LossAction::Hold, "", 0};
    for (const auto& [at, trouble] : {std::pair{1s, "it refuses lights"}, {2s, "it refuses lights"}, {4s, ""}}) {
        status.trouble = trouble;
        watch_.look(at, std::vector{status});
    }
    EXPECT_THAT(told(), ElementsAre("cue controller (usb_hid): it refuses lights",
                                    "cue controller (usb_hid) is all right again after 3.0 s"));
    EXPECT_THAT(reported(), ElementsAre("1-4 cue controller: cue controller (usb_hid): it refuses lights"));
}

// Relays that a hand switched are a loss to their bank, and Lighting says which they are.
TEST_F(WatchOfDevices, leaves_what_happens_to_relays_of_a_bank_that_is_there_to_others) {
    for (const int losses : {0, 1, 2})
        watch_.look(losses * 1s,
                    std::vector{DeviceStatus{"road", "modbus_tcp", DeviceState::Running, LossAction::Hold, "", losses}});
    EXPECT_TRUE(reported().empty());
}

}  // namespace
}  // namespace fantascope::app
