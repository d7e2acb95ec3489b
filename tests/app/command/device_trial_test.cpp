#include "app/command/device_trial.h"

#include "app/parts/part.h"
#include "drivers/registry.h"
#include "drivers/site/world.h"

#include "core/check.h"
#include "media/image.h"
#include "program.h"
#include "scratch_folder.h"

#include <gmock/gmock.h>

#include <csignal>
#include <set>
#include <sstream>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

// A device of the simulated site, tried for five seconds in which things happen to it at every full
// second.
class TrialOfADevice : public testing::Test {
protected:
    template <class Port>
    static std::unique_ptr<Port> opened(Result<std::unique_ptr<Port>> port) {
        FANTASCOPE_CHECK(port.has_value(), "the simulated devices open");
        return std::move(port).value();
    }
    void eachSecond(std::function<void(int second)> happens) {
        clock_.setParts({{"world", 1, 0s, [happens](Time moment) {
                              if (moment < 5s) happens(static_cast<int>(seconds(moment)));
                          }}});
    }
    std::vector<std::string> told() const {
        std::istringstream lines(out_.str());
        std::vector<std::string> told;
        for (std::string line; std::getline(lines, line);) told.push_back(line);
        return told;
    }

    SteppedClock clock_;
    site::World world_{clock_};
    drivers::DriverContext context_{clock_, &world_};
    ConfigNode simulated_ = ConfigNode::parse("driver: simulated\n", "site.yaml").value();
    std::ostringstream out_;
    DeviceTrial trial_{clock_, 5s, nullptr, out_};
};

TEST_F(TrialOfADevice, lamps_light_up_one_after_the_other_and_are_dark_at_the_end) {
    const auto port = opened(drivers::openDmxPort(simulated_, 1, context_));
    std::set<std::size_t> lit;
    clock_.setParts({{"lamps", 10, 50ms, [&](Time) {
                          const auto slots = world_.slots(1);
                          std::size_t full = 0;
                          for (std::size_t slot = 0; slot < slots.size(); ++slot)
                              if (slots[slot] != 0) {
                                  ++full;
                                  lit.insert(slot);
                              }
                          EXPECT_EQ(full, 1u);
                      }}});
    EXPECT_TRUE(trial_.chase(*port, {0, 7, 511}));
    EXPECT_THAT(lit, ElementsAre(0u, 7u, 511u));
    EXPECT_THAT(world_.slots(1), testing::Each(0));
    EXPECT_THAT(told()[1], "slot 1 is at full") << "addresses as they are set at the lamp";
}

TEST_F(TrialOfADevice, relays_click_one_after_the_other_and_are_safe_at_the_end) {
    const std::vector<bool> safe = {true, false};
    const auto bank = opened(drivers::openRelayBank(simulated_, "road", safe, context_));
    std::set<std::vector<bool>> seen;
    clock_.setParts({{"relays", 10, 50ms, [&](Time) { seen.insert(world_.relays("road")); }}});
    EXPECT_TRUE(trial_.click(*bank, safe));
    EXPECT_THAT(seen, ElementsAre(std::vector<bool>{false, false}, safe, std::vector<bool>{true, true}));
    EXPECT_EQ(world_.relays("road"), safe);
}

// Example failure: on the ladder nobody knows what slot 10 is.
TEST_F(TrialOfADevice, calls_things_by_the_names_that_the_site_has_for_them) {
    const auto port = opened(drivers::openDmxPort(simulated_, 1, context_));
    EXPECT_TRUE(trial_.chase(*port, {9}, {{9, "fountain red"}}));
    EXPECT_EQ(told()[1], "fountain red (slot 10) is at full");
}

// A coil that the site does not name may hold anything.
TEST_F(TrialOfADevice, switches_the_relays_that_have_a_name_and_no_others) {
    const std::vector<bool> safe = {true, false, true};
    const auto bank = opened(drivers::openRelayBank(simulated_, "road", safe, context_));
    std::set<std::vector<bool>> seen;
    clock_.setParts({{"relays", 10, 50ms, [&](Time) { seen.insert(world_.relays("road")); }}});
    EXPECT_TRUE(trial_.click(*bank, safe, {{1, "fog"}}));
    EXPECT_THAT(seen, ElementsAre(safe, std::vector<bool>{true, true, true}));
    EXPECT_EQ(told()[1], "fog (coil 1) is on; the bank says on on on");
}

// A bank that says something else than it was told.
class Welded : public RelayBank {
public:
    explicit Welded(std::unique_ptr<RelayBank> good) : good_(std::move(good)) {}
    DeviceStatus status() const override { return good_->status(); }
    std::size_t size() const override { return good_->size(); }
    Result<void> write(const std::vector<bool>& states) override { return good_->write(states); }
    Result<std::vector<bool>> read() override {
        auto states = TRY(good_->read());
        states[1] = true;
        return states;
    }

private:
    std::unique_ptr<RelayBank> good_;
};
TEST_F(TrialOfADevice, a_relay_that_sticks_is_found) {
    Welded bank(opened(drivers::openRelayBank(simulated_, "road", {false, false}, context_)));
    const auto tried = trial_.click(bank, {false, false});
    ASSERT_FALSE(tried);
    EXPECT_EQ(tried.error().message(), "road was told on off and says on on");
    EXPECT_EQ(trial_.click(bank, {false, false}, {{0, "path"}, {1, "fog"}}).error().message(),
              "road was told on off and says on on: look at fog (coil 1)");
}

// Example failure: the module loses its power in the middle of a click, and the trial ends well.
TEST_F(TrialOfADevice, relays_that_are_not_safe_at_the_end_are_told) {
    const auto bank = opened(drivers::openRelayBank(simulated_, "road", {true}, context_));
    eachSecond([&](int second) { world_.setPlugged("road", second != 4); });
    const auto tried = trial_.click(*bank, {true});
    ASSERT_FALSE(tried);
    EXPECT_THAT(tried.error().message(), HasSubstr("RELAYS MAY BE UNSAFE: 'road'"));
}

// Example failure: after Ctrl-C one more lamp lights up, one more relay clicks.
TEST_F(TrialOfADevice, an_interrupted_trial_does_nothing_more) {
    const Interrupt interrupt(Interrupt::Second::IsCounted);
    DeviceTrial trial(clock_, 5s, &interrupt, out_);
    const auto port = opened(drivers::openDmxPort(simulated_, 1, context_));
    eachSecond([&](int second) {
        if (second == 1) std::raise(SIGINT);
    });
    EXPECT_TRUE(trial.chase(*port, {0, 1, 2, 3, 4}));
    EXPECT_THAT(told(), ElementsAre(HasSubstr("is there"), "slot 1 is at full", "slot 2 is at full", "slot 3 is at full"));
    EXPECT_THAT(world_.slots(1), testing::Each(0));
}

// Example failure: `fantascope devices --test street | head -1` goes on clicking for nobody.
TEST_F(TrialOfADevice, a_trial_that_nobody_reads_ends) {
    const auto port = opened(drivers::openDmxPort(simulated_, 1, context_));
    eachSecond([&](int second) {
        if (second == 1) out_.setstate(std::ios::badbit);
    });
    EXPECT_TRUE(trial_.chase(*port, {0}));
    EXPECT_LT(clock_.now(), 2s);
    EXPECT_THAT(world_.slots(1), testing::Each(0));
}

TEST_F(TrialOfADevice, presses_and_contacts_are_told_as_they_come) {
    const auto controller = opened(drivers::openCueController(simulated_, context_));
    eachSecond([&](int second) { world_.press(3, second % 2 == 1); });
    EXPECT_TRUE(trial_.tellPresses(*controller));
    EXPECT_THAT(told(), ElementsAre(HasSubstr("is there"), "button 3 down", "button 3 up", "button 3 down", "button 3 up"));
}

TEST_F(TrialOfADevice, contacts_are_told_and_whether_they_were_found_so) {
    const auto bank = opened(drivers::openInputBank(simulated_, "doors", 2, context_));
    world_.setContact("doors", 1, true);
    eachSecond([&](int second) { world_.setContact("doors", 0, second % 2 == 1); });
    EXPECT_TRUE(trial_.tellContacts(*bank));
    EXPECT_THAT(told(), ElementsAre(HasSubstr("is there"), "input 1 closed, as it was found", "input 0 closed", "input 0 open",
                                    "input 0 closed", "input 0 open"));
}

TEST_F(TrialOfADevice, a_desk_is_told_by_the_slots_that_it_moves) {
    const auto desk = opened(drivers::openDmxSource(simulated_, 1, context_));
    eachSecond([&](int second) {
        DmxInput frame;
        frame.source = "FOH";
        frame.priority = 120;
        frame.slots[9] = static_cast<std::uint8_t>(second < 3 ? 50 : 60);
        world_.sendFromDesk(1, frame);
    });
    EXPECT_TRUE(trial_.tellDesk(*desk));
    EXPECT_THAT(told(), ElementsAre(HasSubstr("is there"), "'FOH' sends with priority 120", "'FOH': slot 10 is 50",
                                    "'FOH': slot 10 is 60"));
}

TEST_F(TrialOfADevice, a_camera_leaves_its_first_picture_and_tells_how_many_came) {
    const ScratchFolder folder;
    const auto camera = opened(drivers::openCamera(simulated_, context_));
    clock_.setParts({{"camera", 4, 100ms, [&](Time moment) {
                          auto frame = std::make_shared<CameraFrame>();
                          frame->image = RgbaImage(8, 4);
                          for (Rgba8& pixel : frame->image.pixels()) pixel = {51, 51, 51, 255};
                          frame->exposed = moment;
                          frame->sequence = static_cast<std::uint64_t>(tickAt(moment - 100ms, 4));
                          if (frame->sequence != 2) world_.sendFromCamera(std::move(frame), moment);
                      }}});
    EXPECT_TRUE(trial_.snapshot(*camera, folder.path() / "seen.png"));
    EXPECT_THAT(told()[1], EndsWith("seen.png: 8 x 4, brightness 0.20 of 1"));
    EXPECT_THAT(told()[2], EndsWith("3.8 pictures a second, 1 missed"));
    EXPECT_EQ(readGrey(folder.path() / "seen.png")->width(), 8);
}

TEST_F(TrialOfADevice, says_why_a_device_is_missing_and_when_it_comes) {
    world_.setPlugged("cue controller", false);
    const auto controller = opened(drivers::openCueController(simulated_, context_));
    eachSecond([&](int second) {
        world_.setPlugged("cue controller", second == 2);
        world_.press(1, second == 2);
    });
    EXPECT_TRUE(trial_.tellPresses(*controller));
    EXPECT_THAT(told(), ElementsAre(HasSubstr("is absent: "), HasSubstr("is there"), "button 1 down", HasSubstr("is absent: ")));
}

TEST_F(TrialOfADevice, is_refused_where_the_device_never_came) {
    world_.setPlugged("camera", false);
    const auto camera = opened(drivers::openCamera(simulated_, context_));
    const auto tried = trial_.snapshot(*camera, "nowhere.png");
    ASSERT_FALSE(tried);
    EXPECT_EQ(tried.error().message(), "camera was not there");
}

// The command itself, on a machine where nothing is declared.
TEST(DevicesCommand, says_what_there_is_and_which_names_a_site_has) {
    const ScratchFolder folder;
    const std::string site = folder.file("site.yaml", R"(fantascope: site
version: 1
outputs: [{name: left, display: {driver: headless}, size: [640, 360], refresh_rate: 30}]
)");
    const auto ran = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), "devices");
        return runProgram(arguments, folder.path());
    };
    const Outcome bare = ran({});
    EXPECT_THAT(bare, exits(0));
    EXPECT_THAT(bare.out, Not(testing::IsEmpty()));
    const Outcome unknown = ran({"--site", site, "--test", "camera"});
    EXPECT_THAT(unknown, exits(1));
    EXPECT_THAT(unknown.errors, HasSubstr("has no device 'camera'"));
    const Outcome output = ran({"--site", site, "--test", "left"});
    EXPECT_THAT(output, exits(1));
    EXPECT_THAT(output.errors, HasSubstr("docs/setting-up.md"));
    EXPECT_THAT(ran({"--watch", "--test", "x"}), exits(2));
    EXPECT_THAT(ran({"--watch", "--seconds", "0.2"}), exits(0));
}

// Example failure: a word too few, and the street goes dark.
TEST(DevicesCommand, switches_relays_only_on_somebodys_word) {
    const ScratchFolder folder;
    const std::string site = folder.file("site.yaml", R"(fantascope: site
version: 1
outputs: [{name: left, display: {driver: headless}, size: [640, 360], refresh_rate: 30}]
relay_banks: [{name: road, device: {driver: modbus_tcp, host: 127.0.0.1, port: 1}}]
relays: [{name: road-north, coil: 0, safe: on}, {name: road-south, coil: 1, safe: on}]
)");
    const std::vector<std::string> arguments = {"devices", "--site", site, "--test", "road", "--seconds", "0.3"};
    const Outcome unasked = runProgram(arguments, folder.path());
    EXPECT_THAT(unasked, exits(1));
    EXPECT_THAT(unasked.errors, HasSubstr("this test switches road-north, road-south, one after the other: add --yes"));
    EXPECT_EQ(typeAtProgram(arguments, folder.path(), {{"y and Enter: ", 1, 'n'}, {"n", 1, '\n'}}), 1);
    std::vector<std::string> allowed = arguments;
    allowed.emplace_back("--yes");
    const Outcome tried = runProgram(allowed, folder.path());
    EXPECT_THAT(tried, exits(1));
    EXPECT_THAT(tried.errors, HasSubstr("road was not there")) << "it was tried";
}

}  // namespace
}  // namespace fantascope::app
