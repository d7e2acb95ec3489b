#include "app/calibrate/corner_choice.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Kind = ScreenEvent::Kind;
using Name = Key::Name;
using Corners = std::vector<glm::dvec2>;

// A camera of 640 x 360 pixels sees a wall that two outputs light. Their light overlaps between the
// columns 280 and 360.
class CornerChoiceTest : public testing::Test {
protected:
    static constexpr glm::ivec2 kCamera{640, 360};
    CornerChoiceTest() { begin({{{100.25, 60}, {540, 60}, {540, 300}, {100.25, 300}}}); }

    void begin(const std::array<glm::dvec2, 4>& corners) {
        const auto lit = [&](int from, int to) {
            vision::ProjectorMap map{Image<glm::vec2>(kCamera.x, kCamera.y, glm::vec2(std::nanf(""))), {}, 0, 0};
            for (int y = 30; y < 330; ++y)
                for (int x = from; x < to; ++x) map.at.at(x, y) = glm::vec2(1);
            return map;
        };
        const vision::ProjectorMap left = lit(60, 360), right = lit(280, 580);
        const vision::CameraModel camera = *vision::CameraModel::fromFieldOfView(Pose{}, kCamera, 1);
        GreyImage picture(kCamera.x, kCamera.y, 0.1f);
        for (int y = 30; y < 330; ++y)
            for (int x = 60; x < 580; ++x) picture.at(x, y) = 0.7f;
        place_.emplace(OpenPlace{"wall",
                                 {"left", "right"},
                                 camera,
                                 picture,
                                 vision::CanvasReach(camera, {{{{0, 0}, {0.55, 1}}, &left}, {{{0.45, 0}, {1, 1}}, &right}}),
                                 corners});
        choice_ = std::make_unique<CornerChoice>(*place_, "Canvas 'wall'");
    }
    // Where the window shows a camera pixel.
    glm::dvec2 at(glm::dvec2 pixel) const { return CornerPicture(*place_).pictureFromCamera(pixel); }
    void key(Name name, bool shift = false, bool control = false) {
        for (const Kind kind : {Kind::KeyDown, Kind::KeyUp}) choice_->take({kind, {name, 0, shift, control}, {}, {}});
    }
    void letter(char letter) { choice_->take({Kind::KeyDown, {.letter = letter}, {}, {}}); }
    void pointer(Kind kind, glm::dvec2 pixel) { choice_->take({kind, {}, at(pixel), {}}); }
    void click(glm::dvec2 pixel) {
        for (const Kind kind : {Kind::PointerMoved, Kind::ButtonDown, Kind::ButtonUp}) pointer(kind, pixel);
    }
    const Corners& corners() const { return choice_->corners(); }
    // Whether Enter is refused, with these words.
    void expectRefusal(const std::string& words) {
        EXPECT_THAT(choice_->obstacle(), HasSubstr(words));
        const RgbaImage before = choice_->picture();
        key(Name::Enter);
        EXPECT_EQ(choice_->state(), CornerChoice::State::Open);
        EXPECT_NE(choice_->picture(), before) << "the refusal is seen";
    }

    std::optional<OpenPlace> place_;
    std::unique_ptr<CornerChoice> choice_;
    const Corners first_ = {{100.25, 60}, {540, 60}, {540, 300}, {100.25, 300}};
};

TEST_F(CornerChoiceTest, begins_with_the_place_that_the_program_would_take_which_may_be_taken) {
    EXPECT_EQ(corners(), first_);
    EXPECT_EQ(choice_->obstacle(), "");
    key(Name::Enter);
    EXPECT_EQ(choice_->state(), CornerChoice::State::Taken);
    EXPECT_EQ(corners(), first_);
    key(Name::Left);
    EXPECT_EQ(corners(), first_) << "it is over";
}

TEST_F(CornerChoiceTest, is_given_up_by_escape) {
    key(Name::Escape);
    EXPECT_EQ(choice_->state(), CornerChoice::State::GivenUp);
    key(Name::Enter);
    EXPECT_EQ(choice_->state(), CornerChoice::State::GivenUp);
}

TEST_F(CornerChoiceTest, moves_the_chosen_corner_by_arrows) {
    EXPECT_EQ(choice_->chosen(), 0u);
    key(Name::Tab);
    EXPECT_EQ(choice_->chosen(), 1u);
    key(Name::Left);
    EXPECT_EQ(corners()[1], glm::dvec2(539, 60));
    key(Name::Down, true);
    EXPECT_EQ(corners()[1], glm::dvec2(539, 70));
    key(Name::Right, false, true);
    EXPECT_EQ(corners()[1], glm::dvec2(539.1, 70));
    key(Name::Up);
    EXPECT_EQ(corners()[1], glm::dvec2(539.1, 69));
    key(Name::Tab, true);
    key(Name::Tab, true);
    EXPECT_EQ(choice_->chosen(), 3u) << "backwards, and round";
    key(Name::Tab);
    key(Name::Right);
    EXPECT_EQ(corners()[0], glm::dvec2(101.3, 60)) << "moved corners lie on tenths";
    EXPECT_EQ(corners()[2], first_[2]);
}

TEST_F(CornerChoiceTest, keeps_the_corners_in_the_camera_s_picture) {
    for (int i = 0; i < 20; ++i) key(Name::Left, true), key(Name::Up, true);
    EXPECT_EQ(corners()[0], glm::dvec2(0, 0));
    pointer(Kind::ButtonDown, {500, 320});
    pointer(Kind::PointerMoved, {900, 900});
    EXPECT_EQ(corners()[2], glm::dvec2(640, 360));
}

TEST_F(CornerChoiceTest, moves_the_nearest_corner_to_a_click_and_along_with_a_drag) {
    click({500, 90});
    EXPECT_EQ(choice_->chosen(), 1u);
    EXPECT_LT(glm::distance(corners()[1], glm::dvec2(500, 90)), 0.1);
    pointer(Kind::PointerMoved, {10, 10});
    EXPECT_LT(glm::distance(corners()[1], glm::dvec2(500, 90)), 0.1) << "the button is not held";
    pointer(Kind::ButtonDown, {130, 280});
    pointer(Kind::PointerMoved, {140, 270});
    pointer(Kind::PointerMoved, {150.04, 260.02});
    EXPECT_EQ(corners()[3], glm::dvec2(150, 260));
    EXPECT_EQ(corners()[0], first_[0]);
}

// Example failure: a person chooses a corner for the magnifier, and it jumps to the pointer.
TEST_F(CornerChoiceTest, only_chooses_a_corner_that_is_clicked_itself) {
    click({537, 296});
    EXPECT_EQ(choice_->chosen(), 2u);
    EXPECT_EQ(corners(), first_);
    pointer(Kind::ButtonDown, {537, 296});
    pointer(Kind::PointerMoved, {538, 296});
    EXPECT_EQ(corners(), first_) << "a hand is not so still";
    pointer(Kind::PointerMoved, {527, 286});
    EXPECT_EQ(corners()[2], glm::dvec2(530, 290)) << "it keeps its distance from the pointer";
}

TEST_F(CornerChoiceTest, ignores_clicks_beside_the_camera_s_picture) {
    for (const glm::dvec2 pixel : {glm::dvec2(-20, 60), glm::dvec2(100, 380), glm::dvec2(100, -20)}) click(pixel);
    EXPECT_EQ(corners(), first_);
}

TEST_F(CornerChoiceTest, begins_anew_with_four_clicks_clockwise) {
    letter('n');
    EXPECT_THAT(corners(), testing::IsEmpty());
    expectRefusal("Click where the top left corner is to be");
    key(Name::Left);  // there is none yet
    key(Name::Tab);
    const Corners places = {{400, 100}, {520, 110}, {530, 200}, {410, 190}};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_THAT(choice_->obstacle(), HasSubstr(CornerPicture::kCorners[i]));
        click(places[i]);
        EXPECT_EQ(choice_->chosen(), i);
    }
    for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(glm::distance(corners()[i], places[i]), 0.1) << i;
    // Not in the light of 'left', although all are in that of 'right'.
    expectRefusal("The light of left does not reach all of the edge: see the bright hatching. Move the corners into the light.");
}

TEST_F(CornerChoiceTest, says_why_a_place_cannot_be_taken) {
    click({100, 20});
    expectRefusal("The light of left does not");
    for (int i = 0; i < 4; ++i) key(Name::Down, true);
    EXPECT_EQ(choice_->obstacle(), "");
    click({540, 20});
    expectRefusal("The light of right does not");
    click({100, 20});
    expectRefusal("The light of left and of right does not");

    begin({{{540, 300}, {540, 60}, {100, 300}, {100, 60}}});
    expectRefusal("The corners are crossed, folded inwards or in a line. Go round clockwise");
    begin({{{100, 60}, {320, 60}, {540, 60}, {100, 300}}});
    expectRefusal("in a line");
}

// A camera behind a screen sees its picture from behind.
TEST_F(CornerChoiceTest, takes_a_mirrored_place_but_tells) {
    begin({{{540, 60}, {100, 60}, {100, 300}, {540, 300}}});
    EXPECT_THAT(choice_->obstacle(), HasSubstr("The light of left and of right does not")) << "each is on the other's side";
    letter('n');
    for (const glm::dvec2 pixel : {glm::dvec2(340, 60), glm::dvec2(300, 60), glm::dvec2(300, 300), glm::dvec2(340, 300)})
        click(pixel);
    EXPECT_EQ(choice_->obstacle(), "");
    key(Name::Enter);
    EXPECT_EQ(choice_->state(), CornerChoice::State::Taken);
}

TEST_F(CornerChoiceTest, takes_moves_back_one_by_one) {
    key(Name::Left);
    key(Name::Left);
    key(Name::Tab);
    pointer(Kind::ButtonDown, {500, 90});
    for (int i = 0; i < 5; ++i) pointer(Kind::PointerMoved, {500.0 - 10 * i, 90});
    pointer(Kind::ButtonUp, {460, 90});
    letter('n');
    click({200, 100});
    key(Name::Right);

    key(Name::Backspace);
    EXPECT_EQ(corners().size(), 1u);
    key(Name::Backspace);
    EXPECT_EQ(corners().size(), 0u);
    key(Name::Backspace);
    ASSERT_EQ(corners().size(), 4u);
    EXPECT_LT(glm::distance(corners()[1], glm::dvec2(460, 90)), 0.1);
    key(Name::Backspace);
    EXPECT_EQ(corners()[1], first_[1]) << "a drag is one move";
    EXPECT_EQ(corners()[0], glm::dvec2(98.3, 60));
    key(Name::Backspace);
    key(Name::Backspace);
    EXPECT_EQ(corners(), first_);
    key(Name::Backspace);
    EXPECT_EQ(corners(), first_);
}

// A held arrow repeats its KeyDown. What moves nothing is no move.
TEST_F(CornerChoiceTest, takes_a_held_arrow_back_as_one_move) {
    for (int i = 0; i < 30; ++i) choice_->take({Kind::KeyDown, {Name::Down}, {}, {}});
    choice_->take({Kind::KeyUp, {Name::Down}, {}, {}});
    for (int i = 0; i < 5; ++i) choice_->take({Kind::KeyDown, {Name::Right}, {}, {}});
    EXPECT_EQ(corners()[0], glm::dvec2(105.3, 90));
    key(Name::Backspace);
    EXPECT_EQ(corners()[0], glm::dvec2(100.25, 90));
    click({100.25, 90});
    key(Name::Backspace);
    EXPECT_EQ(corners()[0], first_[0]);
}

// Example failure: a click in the window lands beside the pointer.
TEST_F(CornerChoiceTest, shows_the_wall_where_clicks_find_it) {
    const RgbaImage picture = choice_->picture();
    ASSERT_EQ(glm::ivec2(picture.width(), picture.height()), CornerPicture::kSize);
    const auto brightness = [&](glm::dvec2 pixel) {
        const glm::ivec2 place(at(pixel));
        return int(picture.at(place.x, place.y).r);
    };
    EXPECT_GT(brightness({320, 33}), 60) << "lit";
    EXPECT_LT(brightness({320, 27}), 60) << "not lit";
    EXPECT_GT(brightness({577, 180}), 60);
    EXPECT_LT(brightness({583, 180}), 60);
    EXPECT_GT(brightness({100.25, 180}), 180) << "the canvas's edge";
}

// Hatched is what no output lights, and brightly what a part's own output does not.
TEST_F(CornerChoiceTest, hatches_what_is_out_of_reach) {
    // How many pixels of a square are brighter than the wall.
    const auto bright = [&](glm::dvec2 pixel) {
        const RgbaImage picture = choice_->picture();
        const glm::ivec2 middle(at(pixel));
        int count = 0;
        for (int y = -10; y < 10; ++y)
            for (int x = -10; x < 10; ++x) count += picture.at(middle.x + x, middle.y + y).r > 110;
        return count;
    };
    EXPECT_EQ(bright({420, 180}), 0) << "the left output does not light it and need not";
    EXPECT_EQ(bright({610, 180}), 0) << "no canvas";
    click({610, 60});
    EXPECT_GT(bright({595, 100}), 20) << "the canvas, in no light";
    letter('n');
    for (const glm::dvec2 pixel : {glm::dvec2(400, 100), glm::dvec2(560, 100), glm::dvec2(560, 300), glm::dvec2(400, 300)})
        click(pixel);
    EXPECT_GT(bright({440, 180}), 20) << "the left part, in the light of 'right' alone";
    EXPECT_EQ(bright({530, 180}), 0);
}

// Bright light at night blinds for minutes.
TEST_F(CornerChoiceTest, is_dim) {
    const RgbaImage picture = choice_->picture();
    double sum = 0;
    for (const Rgba8 pixel : picture.pixels()) sum += linearFromSrgb(pixel.r / 255.0f);
    EXPECT_LT(sum / static_cast<double>(picture.pixels().size()), 0.12);
    EXPECT_TRUE(std::ranges::all_of(picture.pixels(), [](Rgba8 pixel) { return pixel.b <= pixel.g && pixel.g <= pixel.r; }))
        << "it has one warm hue";
}

// The magnifier shows single pixels of the camera at the chosen corner, and never covers it.
TEST_F(CornerChoiceTest, magnifies_the_chosen_corner) {
    for (std::size_t corner = 0; corner < 4; ++corner, key(Name::Tab)) {
        const RgbaImage before = choice_->picture();
        key(Name::Tab);
        const RgbaImage other = choice_->picture();
        key(Name::Tab, true);
        const glm::ivec2 place(at(first_[corner]));
        EXPECT_GT(before.at(place.x + 12, place.y).r, 200) << "the ring of corner " << corner;
        EXPECT_NE(before, other);
    }
}

}  // namespace
}  // namespace fantascope::app
