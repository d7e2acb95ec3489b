// Which monitors are switched on, and where, as monitors come and go. Includes what an X server
// without a graphics card cannot reproduce: unplugged cables, and cards that cannot drive every
// monitor.

#include "drivers/display/placement.h"

#include <gmock/gmock.h>

namespace fantascope::drivers {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr glm::ivec2 kHd{1920, 1080}, kLargest{16384, 16384};
constexpr std::uint32_t kHd60 = 100, kHd50 = 101, kHdFields = 102, kSmall = 103;

// Monitor number n: a projector with serial "Sn" on connector HDMI-n, off, which any of three CRTCs
// can drive.
Monitor projector(std::uint32_t n) {
    Monitor monitor;
    monitor.connector = "HDMI-" + std::to_string(n);
    monitor.outputId = n;
    monitor.connected = true;
    monitor.identity = MonitorIdentity{"EPS", "EPSON PJ", "S" + std::to_string(n)};
    monitor.modes = {{kSmall, {1280, 720}, 60}, {kHdFields, kHd, 60, true}, {kHd60, kHd, 60}, {kHd50, kHd, 50}};
    monitor.possibleCrtcs = {11, 12, 13};
    return monitor;
}

class PlacementOfOutputs : public testing::Test {
protected:
    int claim(const std::string& serial, std::optional<glm::ivec2> position = {}) {
        return placement_.add(
            {"output " + serial, {.connector = "", .make = "", .model = "", .serial = serial}, kHd, 60, position});
    }
    Placement::Plan look() {
        auto plan = placement_.look(monitors_, kLargest);
        for (Monitor& monitor : monitors_) monitor.unplugged = false;
        return plan;
    }
    // The effect of a change, as by the X server.
    void apply(const Placement::Change& change) {
        for (Monitor& monitor : monitors_) {
            if (monitor.on && monitor.on->crtcId == change.crtcId) monitor.on.reset();
            if (monitor.outputId != change.outputId) continue;
            for (const Monitor::Mode& mode : monitor.modes)
                if (mode.modeId == change.modeId) monitor.on = {change.crtcId, {change.corner, mode.size}, mode};
        }
    }
    Placement::Plan obey() {
        auto plan = look();
        for (const Placement::Change& change : plan.changes) apply(change);
        return plan;
    }
    // Applies changes until there are none.
    void settle() {
        for (int round = 0; round < 3; ++round) obey();
        ASSERT_THAT(look().changes, IsEmpty());
    }
    std::string absence(int claim) { return placement_.seats().at(claim).absence; }
    glm::ivec2 corner(int claim) { return placement_.seats().at(claim).area.corner; }

    std::vector<Monitor> monitors_ = {projector(1), projector(2), projector(3)};
    Placement placement_;
};

TEST_F(PlacementOfOutputs, switches_on_side_by_side_in_the_order_of_the_claims) {
    const int second = claim("S2"), first = claim("S1");
    const auto plan = look();
    EXPECT_THAT(plan.changes,
                ElementsAre(Placement::Change{second, 2, 11, kHd60, {0, 0}}, Placement::Change{first, 1, 12, kHd60, {1920, 0}}));
    EXPECT_EQ(plan.screen, glm::ivec2(3840, 1080));
    settle();
    EXPECT_EQ(absence(first), "");
    EXPECT_EQ(corner(first), glm::ivec2(1920, 0));
    EXPECT_FALSE(monitors_[2].on) << "nobody asked for it";
}

// Interlaced lines show two moments, which combs moving edges.
TEST_F(PlacementOfOutputs, takes_an_interlaced_mode_only_where_there_is_no_other) {
    claim("S1");
    monitors_[0].modes = {{kHdFields, kHd, 60, true}, {kHd50, kHd, 50}};
    EXPECT_THAT(look().changes, ElementsAre(testing::Field(&Placement::Change::modeId, kHd50)));
    monitors_[0].modes = {{kHdFields, kHd, 60, true}};
    EXPECT_THAT(look().changes, ElementsAre(testing::Field(&Placement::Change::modeId, kHdFields)));
}

// Without a desktop nobody switches an unplugged monitor off, so its CRTC goes on. Nothing may be
// switched then, because every change of a mode may make the others blink.
TEST_F(PlacementOfOutputs, switches_nothing_when_a_cable_is_pulled_and_plugged_in_again) {
    const int a = claim("S1"), b = claim("S2");
    settle();
    monitors_[0].connected = false;
    monitors_[0].identity.reset();
    EXPECT_THAT(look().changes, IsEmpty());
    EXPECT_THAT(absence(a),
                HasSubstr("there is no monitor {serial: S1} (there is: HDMI-2 {make: EPS, model: EPSON PJ, serial: S2}, "
                          "HDMI-3"));
    EXPECT_EQ(absence(b), "");
    monitors_[0] = [&] {
        Monitor again = projector(1);
        again.on = monitors_[0].on;
        return again;
    }();
    EXPECT_THAT(look().changes, IsEmpty());
    EXPECT_EQ(absence(a), "");
}

// Some drivers switch the picture off with the cable. That must not be taken for a person's wish.
TEST_F(PlacementOfOutputs, switches_on_again_what_went_off_with_its_cable_even_if_it_was_back_at_once) {
    const int a = claim("S1");
    settle();
    monitors_[0].on.reset();
    monitors_[0].unplugged = true;  // and reconnected before the next look
    EXPECT_THAT(obey().changes, SizeIs(1));
    settle();
    EXPECT_EQ(absence(a), "");
}

TEST_F(PlacementOfOutputs, leaves_off_what_somebody_switched_off_until_it_is_plugged_in_again) {
    const int a = claim("S1"), b = claim("S2");
    settle();
    const glm::ivec2 place = corner(a);
    monitors_[0].on.reset();
    for (int time = 0; time < 2; ++time) {
        placement_.retry();
        EXPECT_THAT(look().changes, IsEmpty());
        EXPECT_THAT(absence(a), HasSubstr("was switched off; xrandr --output HDMI-1 --auto"));
    }
    monitors_[0].connected = false;
    EXPECT_THAT(look().changes, IsEmpty());
    monitors_[0].connected = true;
    settle();
    EXPECT_EQ(absence(a), "");
    EXPECT_EQ(corner(a), place);
    EXPECT_EQ(absence(b), "");
}

// A card with as many CRTCs as projectors: the projector comes back on another connector, and its
// old one still holds its CRTC.
TEST_F(PlacementOfOutputs, takes_the_crtc_of_a_monitor_that_is_gone) {
    monitors_.push_back(projector(4));
    monitors_[3].connected = false;
    const int a = claim("S1"), b = claim("S2"), c = claim("S3");
    settle();
    const glm::ivec2 place = corner(b);
    monitors_[1].connected = false;
    look();
    monitors_[3].connected = true;
    monitors_[3].identity->serial = "S2";
    EXPECT_THAT(obey().changes, ElementsAre(Placement::Change{b, 4, 12, kHd60, place}));
    settle();
    for (const int each : {a, b, c}) EXPECT_EQ(absence(each), "");
}

TEST_F(PlacementOfOutputs, says_that_the_card_can_drive_no_further_monitor) {
    for (Monitor& monitor : monitors_) monitor.possibleCrtcs = {11, 12};
    claim("S1");
    claim("S2");
    const int c = claim("S3");
    settle();
    EXPECT_THAT(absence(c), HasSubstr("cannot drive monitor HDMI-3"));
    monitors_[0].on.reset();  // as the message says
    settle();
    EXPECT_EQ(absence(c), "");
}

// Clones share a CRTC; each monitor must get its own.
TEST_F(PlacementOfOutputs, parts_monitors_that_share_a_crtc) {
    const Monitor::Picture picture{11, {{0, 0}, kHd}, monitors_[0].modes[2]};
    monitors_[0].on = monitors_[1].on = picture;
    const int a = claim("S1"), b = claim("S2");
    EXPECT_THAT(look().changes, ElementsAre(Placement::Change{b, 2, 12, kHd60, {1920, 0}}));
    monitors_[1].on = Monitor::Picture{12, {{1920, 0}, kHd}, monitors_[1].modes[2]};
    EXPECT_THAT(look().changes, IsEmpty());
    EXPECT_EQ(absence(a) + absence(b), "");
}

// Whatever grows the screen later makes the others blink.
TEST_F(PlacementOfOutputs, keeps_room_for_who_is_absent_from_the_start) {
    monitors_[0].connected = false;
    const int a = claim("S1"), b = claim("S2");
    const auto plan = obey();
    EXPECT_EQ(plan.screen, glm::ivec2(3840, 1080));
    settle();
    EXPECT_EQ(corner(b), glm::ivec2(1920, 0));
    monitors_[0].connected = true;
    EXPECT_EQ(obey().screen, glm::ivec2(3840, 1080));
    settle();
    EXPECT_EQ(corner(a), glm::ivec2(0, 0));
    EXPECT_EQ(corner(b), glm::ivec2(1920, 0));
}

// An operator's monitor beside the projectors belongs to no output and must not be covered.
TEST_F(PlacementOfOutputs, keeps_clear_of_monitors_that_nobody_claims) {
    monitors_[0].on = Monitor::Picture{11, {{0, 0}, {1280, 720}}, monitors_[0].modes[0]};
    const int b = claim("S2");
    settle();
    EXPECT_EQ(corner(b), glm::ivec2(1280, 0));
    EXPECT_EQ(monitors_[0].on->area.size, glm::ivec2(1280, 720));
}

TEST_F(PlacementOfOutputs, asks_once_for_what_is_refused_and_again_when_told_to) {
    const int a = claim("S1");
    EXPECT_THAT(look().changes, SizeIs(1));
    for (int time = 0; time < 3; ++time) EXPECT_THAT(look().changes, IsEmpty());
    EXPECT_THAT(absence(a), HasSubstr("refuses 1920 x 1080 pixels at 60.00 Hz"));
    placement_.refused(a, "the X screen cannot become larger");
    EXPECT_EQ(absence(a), "the X screen cannot become larger");
    look();
    EXPECT_EQ(absence(a), "the X screen cannot become larger");
    placement_.retry();
    EXPECT_THAT(obey().changes, SizeIs(1));
    settle();
    EXPECT_EQ(absence(a), "");
}

TEST_F(PlacementOfOutputs, says_that_the_screen_would_become_too_large) {
    claim("S1");
    const int b = claim("S2");
    const auto plan = placement_.look(monitors_, {3000, 3000});
    EXPECT_THAT(plan.changes, SizeIs(1));
    EXPECT_EQ(plan.screen, kHd);
    EXPECT_THAT(absence(b), HasSubstr("no room for 1920 x 1080 pixels on the X screen, which can have 3000 x 3000"));
}

TEST_F(PlacementOfOutputs, keeps_a_rotated_picture_that_has_the_size) {
    monitors_[0].modes.push_back({104, {1080, 1920}, 60});
    const int a =
        placement_.add({"portrait", {.connector = "HDMI-1", .make = "", .model = "", .serial = ""}, {1080, 1920}, 60, {}});
    monitors_[0].on = Monitor::Picture{11, {{0, 0}, {1080, 1920}}, monitors_[0].modes[2]};
    EXPECT_THAT(look().changes, IsEmpty());
    EXPECT_EQ(absence(a), "");
}

TEST_F(PlacementOfOutputs, forgets_a_claim_that_ended) {
    const int a = claim("S1");
    settle();
    placement_.remove(a);
    const int again = claim("S1");
    EXPECT_THAT(look().changes, IsEmpty());
    EXPECT_THAT(placement_.seats(), SizeIs(1));
    EXPECT_EQ(absence(again), "");
}

TEST(MonitorText, can_be_copied_into_a_site_file) {
    for (const std::string model : {"EPSON PJ", "a, b", "it's {x}, y", "x: y", "#1", "0x0A1B"}) {
        Monitor monitor = projector(1);
        monitor.identity->model = model;
        const std::string text = monitor.text(), map = text.substr(text.find(' ') + 1);
        const auto node = ConfigNode::parse("monitor: " + map, "site.yaml");
        ASSERT_TRUE(node) << map;
        MonitorChoice choice;
        ConfigFields fields(*node);
        fields.read("monitor", choice, MonitorChoice::fromConfig);
        const auto finished = fields.finish();
        ASSERT_TRUE(finished) << finished.error().message();
        EXPECT_EQ(choice.model, model);
        EXPECT_TRUE(choice.fits(monitor)) << text;
    }
}

}  // namespace
}  // namespace fantascope::drivers
