#include "app/live/setting_up.h"

#include "app/passing_display.h"
#include "app/running_show.h"
#include "app/site/site_file.h"

#include "core/file.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <gmock/gmock.h>

#include <cmath>
#include <deque>
#include <memory>
#include <string>
#include <utility>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using Name = Key::Name;
using testing::HasSubstr;

// A display in front of which somebody stands.
class AttendedDisplay final : public PassingDisplay {
public:
    using PassingDisplay::PassingDisplay;
    std::deque<ScreenEvent> events;

    std::optional<ScreenEvent> pollEvent() override {
        if (events.empty()) return std::nullopt;
        const ScreenEvent event = events.front();
        events.pop_front();
        return event;
    }
};

// Both outputs of the default site in one colour, set up by a person whose site file is a copy.
class SettingUpPart : public testing::Test {
protected:
    SettingUpPart() {
        std::filesystem::copy(sourceFolder() + "/config/simulated", folder_ / "site", std::filesystem::copy_options::recursive);
        run_.site = valueOf(show::readSite(file_));
        for (auto& display : run_.devices.displays) {
            auto attended = std::make_unique<AttendedDisplay>(std::move(display));
            screens_.push_back(attended.get());
            display = std::move(attended);
        }
        const auto sources = render::PictureSources::numbered({run_.show.sources.size(), render::SolidSource{glm::vec3(0.5f)}});
        loop_.emplace(run_.site, run_.inputs, sources, sourceFolder() + "/assets", run_.devices, run_.clock);
        for (std::size_t output = 0; output < 2; ++output) readers_.push_back(&loop_->tap(output).addQueue());
        EXPECT_TRUE(loop_->prepare());
        loop_->begin(show::ShowClock(run_.clock.now(), 30s));  // the cue is faded in
        run_.inputs.submit(run_.jumpTo("Both"));
        setting_.emplace(run_.site, *loop_, run_.devices, show::ShowClock(), run_.events);
        step();
    }
    void step() {
        loop_->step();
        for (std::size_t output = 0; output < 2; ++output)
            while (const render::ShownFrame* const frame = readers_[output]->next(Time::max())) shown_[output] = frame->image;
    }
    // What the outputs show once the part has worked; the second frame is the first one that was
    // drawn afterwards.
    void work() {
        setting_->tick(run_.clock.now(), [this](const Key& key, Time at) { others_.emplace_back(key, at); });
        step();
        step();
    }
    void press(const Key& key) {
        setting_->key(key);
        work();
    }
    std::string told() const {
        std::string text;
        for (const std::string& sentence : run_.told()) text += sentence + "\n";
        return text;
    }
    // Stored green at a place of an output's picture.
    int at(std::size_t output, glm::ivec2 pixel) { return shown_[output].at(pixel.x, pixel.y).g; }

    const ScratchFolder folder_;
    const std::filesystem::path file_ = folder_ / "site/site.yaml";
    RunningShow run_;
    std::vector<AttendedDisplay*> screens_;
    std::optional<FrameLoop> loop_;
    std::optional<SettingUp> setting_;
    std::vector<render::FrameReader*> readers_;
    RgbaImage shown_[2];
    std::vector<std::pair<Key, Time>> others_;
};

constexpr glm::ivec2 kInside(300, 180), kOutside(20, 20);

TEST_F(SettingUpPart, shows_the_grid_on_every_output_and_gives_the_show_back) {
    const RgbaImage before[] = {shown_[0], shown_[1]};
    EXPECT_FALSE(setting_->key({.letter = 'c'})) << "keys belong to the show until it begins";
    press({.letter = 'e'});
    EXPECT_TRUE(setting_->on());
    for (std::size_t output = 0; output < 2; ++output) EXPECT_NE(shown_[output], before[output]);
    EXPECT_NE(shown_[0], shown_[1]) << "one of them is edited, and says so";
    press({.letter = 'e'});
    EXPECT_FALSE(setting_->on());
    for (std::size_t output = 0; output < 2; ++output) EXPECT_EQ(shown_[output], before[output]);
}

// The whole point: what is on the wall moves as the keys are pressed, and stays there for the show.
TEST_F(SettingUpPart, moves_the_picture_on_the_wall) {
    const glm::dvec2 corner = run_.site.outputs[0].projection.warp.shape().corners[0];
    const glm::ivec2 justInside = glm::ivec2(corner) + glm::ivec2(6, 6);
    ASSERT_GT(at(0, justInside), 100);
    press({.letter = 'e'});
    for (int i = 0; i < 3; ++i) press({.name = Name::Right, .shift = true});
    for (int i = 0; i < 3; ++i) press({.name = Name::Down, .shift = true});
    press({.letter = 'e'});
    EXPECT_EQ(at(0, justInside), 0) << "the corner has moved inwards by 30 pixels both ways";
    EXPECT_GT(at(0, kInside), 100);
    EXPECT_EQ(readFile(file_).value(), readFile(sourceFolder() + "/config/simulated/site.yaml").value()) << "nothing was written";
    EXPECT_THAT(told(), HasSubstr("not written to the file"));
}

// Example failure: the picture has another shape after the next start than while its corners were
// set.
TEST_F(SettingUpPart, pictures_are_fitted_to_the_canvas_as_it_is_now) {
    press({.letter = 'e'});
    for (int i = 0; i < 3; ++i) press({.name = Name::Right, .shift = true});
    press({.letter = 'w'});
    const double set = loop_->settingsOf(0).value()->projection.canvasAspect;
    const auto site = readSite(file_);
    ASSERT_TRUE(site) << site.error().message();
    EXPECT_NEAR(set, site->outputs[0].projection.canvasAspect, 1e-3);
    EXPECT_GT(std::abs(set - readSite(sourceFolder() + "/config/simulated").value().outputs[0].projection.canvasAspect), 1e-2);
}

TEST_F(SettingUpPart, writes_the_file_on_demand_and_keeps_the_one_before) {
    const std::string before = readFile(file_).value();
    press({.letter = 'e'});
    press({Name::Right});
    press({.letter = 'w'});
    std::string wanted = before;
    wanted.replace(wanted.find("[123.07, 48.35]"), 15, "[124.07, 48.35]");
    EXPECT_EQ(readFile(file_).value(), wanted);
    EXPECT_EQ(readFile(file_.string() + ".previous").value(), before);
    EXPECT_THAT(told(), HasSubstr("site.yaml is written"));
    for (int i = 0; i < 10; ++i) work();  // a hand that rests
    press({Name::Right});
    press({.letter = 'u'});
    press({.letter = 'e'});
    EXPECT_THAT(told(), HasSubstr("the outputs are set up\n")) << "what was taken back need not be written";
}

// Somebody else has moved the same corner in an editor meanwhile: neither loses work unseen.
TEST_F(SettingUpPart, does_not_write_over_somebody_elses_change_at_once) {
    std::string theirs = readFile(file_).value();
    theirs.replace(theirs.find("[123.07, 48.35]"), 15, "[99, 48.35]");
    ASSERT_TRUE(writeFile(file_, theirs));
    press({.letter = 'e'});
    press({Name::Right});
    press({.letter = 'w'});
    EXPECT_THAT(told(), HasSubstr("not written: "));
    EXPECT_THAT(told(), HasSubstr("changed in the file by somebody else"));
    EXPECT_EQ(readFile(file_).value(), theirs);
    EXPECT_TRUE(setting_->unsaved());
    press({.letter = 'w'});
    EXPECT_THAT(readFile(file_).value(), HasSubstr("[124.07, 48.35]"));
    EXPECT_EQ(readFile(file_.string() + ".previous").value(), theirs);
    EXPECT_FALSE(setting_->unsaved());
}

// Example failures: what was set up here is lost without a word; after that, a write here fails
// since the file is another one.
TEST_F(SettingUpPart, takes_over_what_somebody_else_has_saved) {
    const auto saved = [&](const char* corner) {
        std::string theirs = readFile(file_).value();
        const std::size_t at = theirs.find("48.35]") - 9;
        theirs.replace(at, theirs.find(']', at) + 1 - at, corner);
        EXPECT_TRUE(writeFile(file_, theirs));
        std::vector<Projection> projections;
        for (const show::Output& output : valueOf(show::readSite(file_)).outputs) projections.push_back(output.projection);
        setting_->adopt(projections);
        work();
    };
    const int before = at(0, {170, 100});
    saved("[240.00, 48.35]");
    EXPECT_THAT(told(), HasSubstr("was saved: now set up as it says: left"));
    EXPECT_GT(before, 100);
    EXPECT_LT(at(0, {170, 100}), 10) << "the corner has moved in";
    EXPECT_TRUE(setting_->moves()) << "the camera must not correct it";
    for (int i = 0; i < SettingUp::kRate; ++i) work();
    EXPECT_FALSE(setting_->moves());
    press({.letter = 'e'});
    press({Name::Right});
    saved("[150.00, 48.35]");
    EXPECT_THAT(told(), HasSubstr("what was set up here is not written yet; write it, or undo it"));
    press({.letter = 'u'});
    EXPECT_FALSE(setting_->unsaved());
    work();
    press({Name::Right});
    press({.letter = 'w'});
    EXPECT_THAT(readFile(file_).value(), HasSubstr("[151, 48.35]"));
}

// Example failure: the corner of the left output is written to an output that somebody has put
// before it.
TEST_F(SettingUpPart, writes_to_the_output_of_the_same_name_wherever_it_stands_in_the_file) {
    std::string theirs = readFile(file_).value();
    const std::size_t first = theirs.find("  - name: left");
    theirs.insert(
        first, "  - {name: new, size: [64, 36], display: {driver: headless}, corners: [[0, 0], [64, 0], [64, 36], [0, 36]]}\n");
    ASSERT_TRUE(writeFile(file_, theirs));
    press({.letter = 'e'});
    press({Name::Right});
    press({.letter = 'w'});
    EXPECT_THAT(told(), HasSubstr("not written: "));
    EXPECT_EQ(readFile(file_).value(), theirs);
    press({.letter = 'w'});
    std::string wanted = theirs;
    wanted.replace(wanted.find("[123.07, 48.35]"), 15, "[124.07, 48.35]");
    EXPECT_EQ(readFile(file_).value(), wanted);
}

TEST_F(SettingUpPart, does_not_write_an_output_that_is_gone_from_the_file) {
    std::string theirs = readFile(file_).value();
    theirs.replace(theirs.find("name: left"), 10, "name: west");
    ASSERT_TRUE(writeFile(file_, theirs));
    press({.letter = 'e'});
    press({Name::Right});
    for (int i = 0; i < 2; ++i) press({.letter = 'w'});
    EXPECT_THAT(told(), HasSubstr("there is no output 'left' any more"));
    EXPECT_EQ(readFile(file_).value(), theirs);
}

TEST_F(SettingUpPart, says_why_it_could_not_write) {
    press({.letter = 'e'});
    press({Name::Right});
    std::filesystem::remove(file_);
    press({.letter = 'w'});
    EXPECT_THAT(told(), HasSubstr("not written: "));
    EXPECT_THAT(told(), HasSubstr("site.yaml"));
}

TEST_F(SettingUpPart, drags_a_corner_with_the_mouse_on_any_output) {
    using Kind = ScreenEvent::Kind;
    screens_[1]->events = {{Kind::KeyDown, {.letter = 'e'}}};
    work();
    ASSERT_TRUE(setting_->on());
    const glm::dvec2 corner = run_.site.outputs[1].projection.warp.shape().corners[2];
    screens_[1]->events = {{Kind::PointerMoved, {}, corner + 3.0},
                           {Kind::ButtonDown, {}, corner + 3.0},
                           {Kind::PointerMoved, {}, corner - 50.0},
                           {Kind::ButtonUp, {}, corner - 50.0},
                           {Kind::PointerMoved, {}, {10, 10}}};
    work();
    press({.letter = 'e'});
    EXPECT_EQ(at(1, glm::ivec2(corner) - 10), 0);
    EXPECT_GT(at(1, kInside), 100);
    EXPECT_GT(at(0, kInside), 100) << "the other output is as it was";
}

// The reason stands on the wall until something else is done: letting go of the key is not that.
TEST_F(SettingUpPart, a_refusal_stays_to_be_read) {
    using Kind = ScreenEvent::Kind;
    const auto at0 = [&](const Key& key, bool released) {
        screens_[0]->events.push_back({Kind::KeyDown, key});
        if (released) screens_[0]->events.push_back({Kind::KeyUp, key});
        work();
    };
    at0({.letter = 'e'}, true);
    const RgbaImage before = shown_[0];
    at0({.letter = 'y'}, false);  // there is nothing to do again
    const RgbaImage refused = shown_[0];
    EXPECT_NE(refused, before);
    screens_[0]->events.push_back({Kind::KeyUp, {.letter = 'y'}});
    work();
    EXPECT_EQ(shown_[0], refused);
    at0({.letter = 'h'}, true);
    EXPECT_NE(shown_[0], refused);
}

// A key at an output is as good as one on the terminal.
TEST_F(SettingUpPart, passes_the_shows_keys_on) {
    screens_[0]->events = {{ScreenEvent::Kind::KeyDown, {.letter = ' '}, {}, 70ms}, {ScreenEvent::Kind::KeyUp, {.letter = ' '}}};
    work();
    EXPECT_THAT(others_, testing::ElementsAre(testing::Pair(Key{.letter = ' '}, 70ms))) << "with the moment of the press";
}

// On the ladder there are only the buttons. A direction that is held goes on by itself after a
// moment, and is one thing to take back.
TEST_F(SettingUpPart, is_worked_by_the_hand_controller_alone) {
    using show::Button;
    const auto press = [&](Button button) {
        setting_->button(button, true);
        setting_->button(button, false);
    };
    press(Button::Down);
    EXPECT_FALSE(setting_->on()) << "nothing moves before it has begun";
    press(Button::Edit);
    press(Button::Next);
    setting_->button(Button::Left, true);
    for (int i = 0; i < 30; ++i) work();  // two seconds: half a second's wait, then a step with every tick
    setting_->button(Button::Left, false);
    work();
    press(Button::Write);
    work();
    const auto moved = [&] { return 544.52 - valueOf(show::readSite(file_)).outputs[0].projection.warp.shape().corners[1].x; };
    EXPECT_GT(moved(), 15);
    EXPECT_LT(moved(), 31);
    press(Button::Undo);
    for (int tool = 0; tool < 4; ++tool) press(Button::Tool);  // mesh, part, masks, light
    press(Button::Down);
    press(Button::Write);
    press(Button::Edit);
    work();
    EXPECT_LT(valueOf(show::readSite(file_)).outputs[0].projection.light.brightness, 1);
    EXPECT_EQ(moved(), 0);
    EXPECT_FALSE(setting_->on());
}

// Two outputs that come to lie on each other begin to blend as soon as the show is seen again.
TEST_F(SettingUpPart, blends_follow_the_warps) {
    show::Site site = run_.site;
    for (show::Output& output : site.outputs) output.canvas = "wall";
    for (std::size_t i = 0; i < 2; ++i) {
        WarpShape shape{.part = {{0.5 * i, 0}, {0.5 + 0.5 * i, 1}}, .corners = rectangleCorners(640, 360)};
        site.outputs[i].projection.warp = Warp::of(shape).value();
    }
    setting_.emplace(site, *loop_, run_.devices, show::ShowClock(), run_.events);
    press({.letter = 'e'});
    press({.letter = 'p'});
    press({.name = Name::Tab});
    press({.name = Name::Tab});  // the right edge of the left picture
    for (int i = 0; i < 10; ++i) press({.name = Name::Right, .shift = true});
    int lit = 0;
    for (int y = 0; y < 360; ++y) lit += at(0, {639, y}) > 100 ? 1 : 0;
    EXPECT_GT(lit, 0) << "the grid is whole up to the edge";
    press({.letter = 'e'});
    EXPECT_LT(at(0, {638, 180}), 20) << "in the overlap the left picture makes way";
    EXPECT_GT(at(0, kInside), 180);
}

// What a mask hides is dark in the show, and whole again while the grid is looked at, with the
// mask's outline on it.
TEST_F(SettingUpPart, masks_hide_a_part_of_the_show) {
    const int before = at(0, kInside);
    press({.letter = 'e'});
    press({.letter = 'n'});
    const RgbaImage outlined = shown_[0];
    press({.letter = 'c'});
    EXPECT_NE(shown_[0], outlined);
    press({.letter = 'e'});
    EXPECT_EQ(at(0, kInside), 0);
    EXPECT_EQ(at(1, kInside), before) << "the other output has none";
    press({.letter = 'e'});
    press({.letter = 'k'});
    press({.letter = 'v'});
    press({.letter = 'e'});
    EXPECT_EQ(at(0, kInside), before);
}

TEST_F(SettingUpPart, says_what_is_wrong_and_keeps_the_picture) {
    press({.letter = 'e'});
    press({.letter = 'c'});
    const RgbaImage before = shown_[0];
    for (int i = 0; i < 2; ++i) press({.name = Name::Tab});
    const RgbaImage third = shown_[0];
    for (int i = 0; i < 60; ++i) press({.name = Name::Left, .shift = true});  // over the other corners at last
    press({.letter = 'e'});
    const show::Site written = valueOf(show::readSite(file_));
    const auto& corners = written.outputs[0].projection.warp.shape().corners;
    EXPECT_EQ(corners[2], glm::dvec2(538.42, 324.85)) << "the file is as it was";
    EXPECT_GT(at(0, {200, 120}), 100) << "and a picture is on the wall";
    EXPECT_NE(before, third);
}

}  // namespace
}  // namespace fantascope::app
