// Projectors bound by identity, on a real X server with several outputs: what a display driver goes
// through on a night on which somebody pulls cables, swaps them and switches projectors off.

#include "drivers/display/glfw.h"
#include "drivers/registry.h"

#include "allocations.h"
#include "contract/eventually.h"
#include "contract/projectors.h"
#include "core/check.h"
#include "edid_block.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace fantascope::contract {
namespace {

using testing::AllOf;
using testing::DoubleNear;
using testing::Eq;
using testing::HasSubstr;
using testing::Optional;

constexpr glm::ivec2 kSize = Projectors::kSize;
using Pixel = std::array<std::uint8_t, 3>;

std::vector<std::uint8_t> edidOf(std::string_view serial) { return edidBlock({.serial = serial}); }

class FullscreenOutputs : public testing::Test {
protected:
    struct Output {
        std::unique_ptr<DisplaySink> sink;
        int picture = 0;  // which one it shows
        int frames = 0;   // that it has shown
    };

    void SetUp() override {
        auto projectors = Projectors::start();
        ASSERT_TRUE(projectors) << projectors.error().message();
        projectors_ = std::move(projectors).value();
    }

    // Three projectors A, B and C on DUMMY0 to DUMMY2, side by side.
    void hang() {
        for (int i = 0; i < 3; ++i) {
            const std::string connector = fmt::format("DUMMY{}", i);
            projectors_->switchOn(connector, {i * kSize.x, 0});
            projectors_->plug(connector, edidOf(std::string(1, static_cast<char>('A' + i))));
        }
    }

    Output& open(const std::string& name, const std::string& keys, glm::ivec2 size = kSize, double hertz = 60) {
        auto sink =
            drivers::openDisplay(*ConfigNode::parse("{driver: glfw, " + keys + "}", "site.yaml"), {name, size, hertz}, {clock_});
        FANTASCOPE_CHECK(sink.has_value(), sink.error().message());
        Output& output = outputs_.emplace_back();
        output.sink = std::move(sink).value();
        output.picture = static_cast<int>(outputs_.size());
        return output;
    }
    Output& openSerial(const std::string& serial) { return open(serial, "monitor: {serial: " + serial + "}"); }

    // The cells of picture number `picture`, 20 x 20 pixels each, are all different, and different
    // in every picture.
    static Pixel colourOf(int picture, glm::ivec2 cell) {
        return {static_cast<std::uint8_t>(picture * 50 + cell.y), static_cast<std::uint8_t>(cell.x * 7),
                static_cast<std::uint8_t>(255 - cell.y * 11)};
    }
    static constexpr int kCell = 20;

    void draw(const Output& output) {
        glBindFramebuffer(GL_FRAMEBUFFER, output.sink->framebuffer());
        glDisable(GL_FRAMEBUFFER_SRGB);
        glEnable(GL_SCISSOR_TEST);
        const glm::ivec2 size = output.sink->size();
        for (int y = 0; y < size.y / kCell; ++y)
            for (int x = 0; x < size.x / kCell; ++x) {
                const auto [red, green, blue] = colourOf(output.picture, {x, y});
                const GLfloat colour[] = {float(red) / 255, float(green) / 255, float(blue) / 255, 1};
                glScissor(x * kCell, size.y - (y + 1) * kCell, kCell, kCell);
                glClearBufferfv(GL_COLOR, 0, colour);
            }
        glDisable(GL_SCISSOR_TEST);
    }

    // Shows a frame on every present output, like the frame loop: the first leads, the others
    // follow.
    void frame() {
        std::vector<Output*> drawn;
        for (Output& output : outputs_)
            if (output.sink->poll() && output.sink->makeCurrent()) {
                draw(output);
                FANTASCOPE_CHECK(output.sink->finish().has_value(), "its context is there");
                drawn.push_back(&output);
            }
        std::optional<Time> leading;
        for (Output* output : drawn) {
            const auto shown = leading ? output->sink->presentWith(*leading) : output->sink->present();
            if (!shown) continue;
            ++output->frames;
            leading = shown->at;
        }
    }
    // Shows frames until the condition holds, because changes travel through the X server. After an
    // absurd number it gives up.
    bool framesUntil(const std::function<bool()>& so) {
        for (int frames = 0; frames < 5'000; ++frames) {
            if (so()) return true;
            frame();
        }
        return so();
    }
    static bool runs(const Output& output) { return output.sink->status().state == DeviceState::Running; }
    static std::string detailOf(const Output& output) { return output.sink->status().detail; }

    // The first wrong pixel on the screen if these pictures should be in these areas; "" if none is
    // wrong.
    std::string wrongPixel(const std::map<int, glm::ivec2>& cornersOfPictures, glm::ivec2 size = kSize) {
        const auto rows = projectors_->server().rows();
        for (const auto& [picture, corner] : cornersOfPictures)
            for (int y = 0; y < size.y; ++y)
                for (int x = 0; x < size.x; ++x) {
                    const glm::ivec2 at = corner + glm::ivec2(x, y);
                    if (at.y >= int(rows.size()) || at.x >= int(rows[0].size())) return "the screen is too small";
                    const Pixel seen = rows[std::size_t(at.y)][std::size_t(at.x)];
                    const Pixel wanted = colourOf(picture, glm::ivec2(x, y) / kCell);
                    if (seen != wanted)
                        return fmt::format("picture {}, pixel {}, {} is {}, not {}", picture, x, y, fmt::join(seen, " "),
                                           fmt::join(wanted, " "));
                }
        return "";
    }
    glm::ivec2 cornerOf(const std::string& connector) const {
        const auto picture = projectors_->picture(connector);
        FANTASCOPE_CHECK(picture.has_value(), connector + " is off");
        return picture->corner;
    }

    std::unique_ptr<Projectors> projectors_;
    ManualClock clock_;
    std::deque<Output> outputs_;  // destroyed before the X server
};

// As X starts without a desktop: the first projector shows something, the others are dark.
TEST_F(FullscreenOutputs, are_switched_on_side_by_side_and_filled_pixel_by_pixel) {
    hang();
    projectors_->switchOff("DUMMY1");
    projectors_->switchOff("DUMMY2");
    for (const char* serial : {"B", "A", "C"}) ASSERT_TRUE(runs(openSerial(serial))) << detailOf(outputs_.back());
    frame();
    EXPECT_EQ(wrongPixel({{1, cornerOf("DUMMY1")}, {2, cornerOf("DUMMY0")}, {3, cornerOf("DUMMY2")}}), "");
    for (const char* connector : {"DUMMY0", "DUMMY1", "DUMMY2"}) EXPECT_EQ(projectors_->picture(connector)->size, kSize);
    EXPECT_EQ(cornerOf("DUMMY0"), glm::ivec2(0)) << "it was on and well";
}

// Also as X starts without a desktop: every projector shows the same part of the screen.
TEST_F(FullscreenOutputs, that_show_the_same_are_taken_apart) {
    hang();
    for (const char* connector : {"DUMMY0", "DUMMY1", "DUMMY2"}) projectors_->switchOn(connector, {0, 0});
    for (const char* serial : {"A", "B", "C"}) openSerial(serial);
    frame();
    EXPECT_EQ(wrongPixel({{1, cornerOf("DUMMY0")}, {2, cornerOf("DUMMY1")}, {3, cornerOf("DUMMY2")}}), "");
}

// A desktop may have arranged them well, and each change of a mode makes a projector dark for
// seconds.
TEST_F(FullscreenOutputs, that_are_on_already_stay_where_they_are) {
    hang();
    projectors_->switchOn("DUMMY2", {0, 200});
    projectors_->switchOn("DUMMY0", {700, 100});
    for (const char* serial : {"A", "B", "C"}) openSerial(serial);
    frame();
    EXPECT_EQ(wrongPixel({{1, {700, 100}}, {2, {kSize.x, 0}}, {3, {0, 200}}}), "");
    EXPECT_EQ(cornerOf("DUMMY0"), glm::ivec2(700, 100));
    EXPECT_EQ(cornerOf("DUMMY2"), glm::ivec2(0, 200));
}

TEST_F(FullscreenOutputs, come_to_the_positions_that_the_site_asks_for) {
    hang();
    Output& left = open("left", "monitor: {serial: A}");
    Output& right = open("right", "monitor: {serial: C}, position: [0, 40]");
    ASSERT_TRUE(framesUntil([&] { return runs(left) && runs(right) && wrongPixel({{2, {0, 40}}}).empty(); })) << detailOf(right);
    EXPECT_EQ(cornerOf("DUMMY2"), glm::ivec2(0, 40));
    EXPECT_EQ(wrongPixel({{1, cornerOf("DUMMY0")}}), "") << "it had to make room";
    EXPECT_THAT(detailOf(open("middle", "monitor: {serial: B}, position: [319, 100]")), HasSubstr("cover output 'right'"));
}

TEST_F(FullscreenOutputs, go_on_when_another_is_switched_off_and_have_it_back_when_it_is_switched_on) {
    hang();
    for (const char* serial : {"A", "B", "C"}) openSerial(serial);
    frame();
    Output &a = outputs_[0], &b = outputs_[1], &c = outputs_[2];
    for (Output* lost : {&b, &a}) {  // a leader, too
        const std::string connector = lost == &a ? "DUMMY0" : "DUMMY1";
        const glm::ivec2 corner = cornerOf(connector);
        projectors_->switchOff(connector);
        ASSERT_TRUE(framesUntil([&] { return !runs(*lost); }));
        EXPECT_THAT(detailOf(*lost), AllOf(HasSubstr("switched off"), HasSubstr("xrandr --output " + connector + " --auto")));
        EXPECT_FALSE(projectors_->server().hasWindow(lost->sink->status().name));

        const int framesOfLost = lost->frames;
        const std::array before = {a.frames, b.frames, c.frames};
        for (int i = 0; i < 20; ++i) frame();
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_EQ(outputs_[i].frames - before[i], &outputs_[i] == lost ? 0 : 20) << "output " << i;
        EXPECT_EQ(lost->frames, framesOfLost);
        EXPECT_EQ(projectors_->picture(connector), std::nullopt) << "whoever switched it off wanted it";

        // Somebody switches it on in its preferred mode; it gets its own mode and place again.
        projectors_->switchOn(connector, {0, 300}, Projectors::kLarge);
        ASSERT_TRUE(framesUntil([&] { return runs(*lost); })) << detailOf(*lost);
        frame();
        EXPECT_EQ(cornerOf(connector), corner);
        EXPECT_EQ(projectors_->picture(connector)->size, kSize);
        EXPECT_EQ(wrongPixel({{1, cornerOf("DUMMY0")}, {2, cornerOf("DUMMY1")}, {3, cornerOf("DUMMY2")}}), "");
    }
    EXPECT_EQ(c.frames, std::max(a.frames, std::max(b.frames, c.frames))) << "it missed a frame of the others";
    EXPECT_EQ(a.sink->status().losses, 1);
    EXPECT_EQ(b.sink->status().losses, 1);
    EXPECT_EQ(c.sink->status().losses, 0);
}

TEST_F(FullscreenOutputs, follow_their_projectors_when_cables_are_changed_over) {
    hang();
    for (const char* serial : {"A", "B", "C"}) openSerial(serial);
    frame();
    projectors_->plug("DUMMY0", {});  // one after the other, as by hand
    ASSERT_TRUE(framesUntil([&] { return !runs(outputs_[0]); }));
    EXPECT_THAT(detailOf(outputs_[0]), AllOf(HasSubstr("there is no monitor {serial: A}"), HasSubstr("DUMMY0 (without EDID)"),
                                             HasSubstr("DUMMY1 {make: EPS, model: EPSON PJ, serial: B}")));
    projectors_->plug("DUMMY2", edidOf("A"));
    ASSERT_TRUE(framesUntil([&] { return !runs(outputs_[2]) && runs(outputs_[0]); })) << detailOf(outputs_[0]);
    const int frames = outputs_[1].frames;
    projectors_->plug("DUMMY0", edidOf("C"));
    ASSERT_TRUE(framesUntil([&] { return runs(outputs_[2]); })) << detailOf(outputs_[2]);
    frame();
    EXPECT_EQ(wrongPixel({{1, cornerOf("DUMMY2")}, {2, cornerOf("DUMMY1")}, {3, cornerOf("DUMMY0")}}), "");
    EXPECT_EQ(outputs_[1].sink->status().losses, 0);
    EXPECT_GT(outputs_[1].frames, frames);
}

// No event arrived between the two changes.
TEST_F(FullscreenOutputs, follow_their_projectors_when_two_change_places_at_once) {
    hang();
    for (const char* serial : {"A", "B", "C"}) openSerial(serial);
    frame();
    projectors_->plug("DUMMY0", edidOf("B"));
    projectors_->plug("DUMMY1", edidOf("A"));
    const std::map<int, glm::ivec2> changed = {{1, cornerOf("DUMMY1")}, {2, cornerOf("DUMMY0")}, {3, cornerOf("DUMMY2")}};
    EXPECT_TRUE(framesUntil([&] { return wrongPixel(changed).empty(); })) << wrongPixel(changed);
}

TEST_F(FullscreenOutputs, that_are_absent_at_the_start_come_later_on_any_connector) {
    hang();
    Output& a = openSerial("A");
    Output& d = openSerial("D");
    EXPECT_TRUE(runs(a));
    EXPECT_EQ(d.sink->status().state, DeviceState::Absent);
    for (int i = 0; i < 5; ++i) frame();
    EXPECT_EQ(a.frames, 5);
    EXPECT_EQ(d.frames, 0);

    projectors_->switchOn("DUMMY7", {0, 0}, Projectors::kLarge);
    projectors_->plug("DUMMY7", edidOf("D"));
    ASSERT_TRUE(framesUntil([&] { return runs(d); })) << detailOf(d);
    frame();
    EXPECT_EQ(wrongPixel({{1, cornerOf("DUMMY0")}, {2, cornerOf("DUMMY7")}}), "");
    EXPECT_EQ(d.sink->status().losses, 0) << "what was never there was not lost";
}

// Example failure: a machine that is short of memory when a projector is switched on ends the show,
// or nobody looks at the monitors any more.
TEST_F(FullscreenOutputs, are_followed_again_after_a_moment_without_memory) {
    hang();
    Output& a = openSerial("A");
    Output& d = openSerial("D");
    {
        const FailingAllocations failing;
        projectors_->switchOn("DUMMY7", {0, 0}, Projectors::kLarge);
        projectors_->plug("DUMMY7", edidOf("D"));
        eventually("somebody has looked for the monitor", [&] {
            frame();
            return failing.failures() > 0;
        });
        const int before = a.frames;
        for (int i = 0; i < 5; ++i) frame();
        EXPECT_EQ(a.frames, before + 5) << "it needs nobody who looks";
    }
    eventually("the other output is there", [&] {
        frame();
        return runs(d) && runs(a);
    });
    frame();
    EXPECT_EQ(wrongPixel({{1, cornerOf("DUMMY0")}, {2, cornerOf("DUMMY7")}}), "");
}

// `xrandr` makes the X server probe its connectors before it switches one on, not after.
TEST_F(FullscreenOutputs, see_a_monitor_that_the_x_server_has_not_looked_at_since) {
    projectors_->switchOn("DUMMY1", {kSize.x, 0}, kSize, 60, Projectors::Looks::Before);
    EXPECT_TRUE(runs(open("early", "monitor: DUMMY1"))) << detailOf(outputs_[0]);
    Output& late = open("late", "monitor: DUMMY2");
    EXPECT_FALSE(runs(late));
    projectors_->switchOn("DUMMY2", {2 * kSize.x, 0}, kSize, 60, Projectors::Looks::Before);
    EXPECT_TRUE(framesUntil([&] { return runs(late); })) << detailOf(late);
}

// The place of an absent output stays reserved: a picture that comes back moves no other.
TEST_F(FullscreenOutputs, come_back_to_their_place_on_another_connector_switched_on_by_us) {
    hang();
    projectors_->switchOn("DUMMY3", {3 * kSize.x, 0});
    projectors_->switchOff("DUMMY3");
    for (const char* serial : {"A", "B", "C"}) openSerial(serial);
    frame();
    const glm::ivec2 place = cornerOf("DUMMY1");
    projectors_->plug("DUMMY1", {});
    projectors_->switchOff("DUMMY1");
    ASSERT_TRUE(framesUntil([&] { return !runs(outputs_[1]); }));
    EXPECT_FALSE(projectors_->picture("DUMMY3"));
    projectors_->plug("DUMMY3", edidOf("B"));
    ASSERT_TRUE(framesUntil([&] { return runs(outputs_[1]); })) << detailOf(outputs_[1]);
    frame();
    EXPECT_EQ(cornerOf("DUMMY3"), place);
    EXPECT_EQ(wrongPixel({{1, cornerOf("DUMMY0")}, {2, place}, {3, cornerOf("DUMMY2")}}), "");
}

TEST_F(FullscreenOutputs, follow_a_monitor_that_somebody_moves) {
    hang();
    for (const char* serial : {"A", "B", "C"}) openSerial(serial);
    projectors_->switchOn("DUMMY0", {100, 200});
    const std::map<int, glm::ivec2> moved = {{1, {100, 200}}, {2, cornerOf("DUMMY1")}, {3, cornerOf("DUMMY2")}};
    EXPECT_TRUE(framesUntil([&] { return wrongPixel(moved).empty(); })) << wrongPixel(moved);
    EXPECT_EQ(cornerOf("DUMMY0"), glm::ivec2(100, 200));
}

TEST_F(FullscreenOutputs, ask_which_one_is_meant_where_two_projectors_are_alike) {
    hang();
    projectors_->plug("DUMMY1", edidOf("A"));
    Output& output = openSerial("A");
    EXPECT_EQ(output.sink->status().state, DeviceState::Absent);
    EXPECT_THAT(detailOf(output), HasSubstr("may be any of DUMMY0 {make: EPS, model: EPSON PJ, serial: A}, DUMMY1"));
    EXPECT_THAT(detailOf(output), HasSubstr("connector: DUMMY0 or connector: DUMMY1"));
    Output& told = open("told", "monitor: {serial: A, connector: DUMMY1}");
    EXPECT_TRUE(runs(told)) << detailOf(told);
    frame();
    EXPECT_EQ(wrongPixel({{2, cornerOf("DUMMY1")}}), "");

    projectors_->plug("DUMMY1", edidOf("B"));  // now they differ
    EXPECT_TRUE(framesUntil([&] { return runs(output) && !runs(told); })) << detailOf(output);
}

TEST_F(FullscreenOutputs, of_one_monitor_are_refused_but_the_first) {
    hang();
    Output& first = openSerial("A");
    Output& second = open("second", "monitor: DUMMY0");
    EXPECT_THAT(detailOf(second), HasSubstr("already belongs to output 'A'"));
    frame();
    EXPECT_EQ(first.frames, 1);
    EXPECT_EQ(wrongPixel({{1, cornerOf("DUMMY0")}}), "");
}

// GLFW knows only whole Hz. Over a night the difference is a minute and a half.
TEST_F(FullscreenOutputs, run_at_the_exact_rate_that_is_nearest_to_the_asked_one) {
    hang();
    EXPECT_THAT(open("a", "monitor: DUMMY0", kSize, 59.94).sink->refreshRate(), DoubleNear(59.94, 1e-6));
    EXPECT_THAT(open("b", "monitor: DUMMY1", kSize, 60).sink->refreshRate(), DoubleNear(60, 1e-6));
    EXPECT_THAT(open("c", "monitor: DUMMY2", kSize, 100).sink->refreshRate(), DoubleNear(75, 1e-6));
    EXPECT_THAT(projectors_->picture("DUMMY0")->hertz, DoubleNear(59.94, 1e-6));
    EXPECT_THAT(projectors_->picture("DUMMY1")->hertz, DoubleNear(60, 1e-6));
    EXPECT_THAT(projectors_->picture("DUMMY2")->hertz, DoubleNear(75, 1e-6));
}

TEST_F(FullscreenOutputs, say_which_sizes_there_are_where_there_is_not_theirs) {
    hang();
    EXPECT_THAT(detailOf(open("left", "monitor: DUMMY0", {1000, 700})),
                AllOf(HasSubstr("has no mode of 1000 x 700 pixels"), HasSubstr("[320, 180]"), HasSubstr("[640, 360]")));
    EXPECT_EQ(projectors_->picture("DUMMY0")->size, kSize) << "nothing was switched";
}

// All three are wider than the X screen was.
TEST_F(FullscreenOutputs, change_to_the_mode_of_their_size) {
    hang();
    for (int i = 0; i < 3; ++i) {
        Output& output = open(fmt::format("{}", i), fmt::format("monitor: DUMMY{}", i), Projectors::kLarge);
        ASSERT_TRUE(runs(output)) << detailOf(output);
    }
    frame();
    for (const char* connector : {"DUMMY0", "DUMMY1", "DUMMY2"})
        EXPECT_EQ(projectors_->picture(connector)->size, Projectors::kLarge);
    EXPECT_EQ(wrongPixel({{1, cornerOf("DUMMY0")}, {2, cornerOf("DUMMY1")}, {3, cornerOf("DUMMY2")}}, Projectors::kLarge), "");
}

TEST_F(FullscreenOutputs, keep_the_screen_from_going_dark_and_show_no_pointer) {
    hang();
    const int before = projectors_->blanksAfter();
    EXPECT_GT(before, 0);
    for (const char* serial : {"A", "B", "C"}) openSerial(serial);
    EXPECT_EQ(projectors_->blanksAfter(), 0);
    for (const int x : {10, 330, 700}) EXPECT_FALSE(projectors_->pointerSeenAt({x, 90})) << x;
    outputs_.clear();
    EXPECT_EQ(projectors_->blanksAfter(), before) << "others may want it after the show";
    EXPECT_TRUE(projectors_->pointerSeenAt({10, 90})) << "this test sees pointers";
}

TEST_F(FullscreenOutputs, are_known_by_the_whole_of_what_the_site_says) {
    hang();
    EXPECT_TRUE(runs(open("a", "monitor: {make: EPS, model: EPSON PJ, serial: A}")));
    EXPECT_THAT(detailOf(open("b", "monitor: {make: BNQ, serial: B}")), HasSubstr("there is no monitor {make: BNQ, serial: B}"));
    EXPECT_THAT(detailOf(open("c", "monitor: {connector: DUMMY1, serial: C}")), HasSubstr("there is no monitor"));
}

TEST(MonitorKeys, are_read_strictly) {
    ManualClock clock;
    const auto refused = [&](const std::string& keys) {
        const auto sink = drivers::openDisplay(*ConfigNode::parse("{driver: glfw, " + keys + "}", "site.yaml"), {}, {clock});
        return sink ? "taken" : sink.error().message();
    };
    EXPECT_THAT(refused("monitor: {serail: X}"), HasSubstr("did you mean 'serial'"));
    EXPECT_THAT(refused("monitor: {}"), HasSubstr("give at least one of connector, make, model, serial"));
    EXPECT_THAT(refused("monitor: [a]"), HasSubstr("a text is needed"));
    EXPECT_THAT(refused("position: [0, 0]"), HasSubstr("'position' needs 'monitor'"));
    EXPECT_THAT(refused("monitor: a, position: [0, -1]"), HasSubstr("position"));
    EXPECT_THAT(refused("monitor: a, position: [0]"), HasSubstr("position"));
}

}  // namespace
}  // namespace fantascope::contract
