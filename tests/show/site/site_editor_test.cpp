#include "show/site/site_editor.h"

#include "core/file.h"
#include "core/random.h"
#include "media/image.h"
#include "scratch_folder.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace fantascope::show {
namespace {

using edit::Tool;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// As a technician writes it, with remarks that must stay.
constexpr const char* kSite = R"(# the wall behind the church
fantascope: site
version: 1
outputs:
  - name: left   # on the tall ladder
    display: {driver: headless}
    size: [640, 360]
    refresh_rate: 30
    # measured on Friday
    corners: [[12, 8], [628, 0], [640, 360], [0, 350]]
    light: {gamma: 2.2}  # by its manual
  - {name: right, display: {driver: headless}, size: [640, 360], refresh_rate: 30}  # behind the door
)";

struct Edited {
    ScratchFolder folder;
    std::filesystem::path file = folder.file("site.yaml", kSite);
    SiteEditor editor{readSite(file).value()};

    std::string apply(const EditCommand& command) {
        const auto done = editor.apply(command);
        return done ? "" : done.error().message();
    }
    // Writes what has changed as the program does, and reads the file anew.
    Site savedAndRead() {
        ConfigDocument document = ConfigDocument::load(file).value();
        for (const SiteEditor::Change& change : editor.unsaved()) {
            const auto done = change.value ? document.set(change.path, *change.value) : document.erase(change.path);
            EXPECT_TRUE(done) << done.error().message();
        }
        const auto written = document.save();
        EXPECT_TRUE(written) << written.error().message();
        editor.saved();
        const auto read = readSite(file);
        EXPECT_TRUE(read) << read.error().message() << "\n" << document.text();
        return read.value();
    }
    const WarpShape& warp(std::size_t output = 0) const { return editor.site().outputs[output].projection.warp.shape(); }
};

bool sameProjection(const Projection& a, const Projection& b) {
    return a.size == b.size && a.warp.shape() == b.warp.shape() && a.masks == b.masks && a.light == b.light;
}

TEST(SiteEditor, moves_the_chosen_corner_by_coarse_and_fine_steps) {
    Edited edited;
    EXPECT_EQ(edited.apply(edit::Move{{1, 0}}), "");
    EXPECT_EQ(edited.warp().corners[0], glm::dvec2(13, 8));
    edited.apply(edit::StepSize{1});
    edited.apply(edit::Move{{0, -1}});
    EXPECT_EQ(edited.warp().corners[0], glm::dvec2(13, -2));
    edited.apply(edit::StepSize{-1});
    edited.apply(edit::StepSize{-1});
    edited.apply(edit::StepSize{-1});  // there is nothing finer
    edited.apply(edit::Handle{2});
    for (int i = 0; i < 3; ++i) edited.apply(edit::Move{{-1, -1}});
    EXPECT_EQ(edited.warp().corners[2], glm::dvec2(639.7, 359.7)) << "and no crumbs of binary numbers";
    EXPECT_THAT(edited.editor.lines(), ElementsAre("left  corners: bottom right", "639.70, 359.70   step 0.1 px", "not saved"));
    edited.apply(edit::Output{1});
    edited.apply(edit::Move{{1, 1}});
    EXPECT_EQ(edited.warp(1).corners[2], glm::dvec2(640.1, 360.1)) << "the other output's corner of the same name";
}

TEST(SiteEditor, moves_the_whole_picture_by_its_middle) {
    Edited edited;
    const auto before = edited.warp().corners;
    edited.apply(edit::Handle{-1});
    EXPECT_EQ(edited.editor.handles()[edited.editor.handle()].label, "whole picture");
    edited.apply(edit::Move{{3, -2}});
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(edited.warp().corners[i], before[i] + glm::dvec2(3, -2));
}

// The mouse: whatever is nearest comes along, and ends exactly under it, with a mesh and without.
TEST(SiteEditor, drags_what_is_nearest_to_where_it_is_wanted) {
    Edited edited;
    edited.apply(edit::Grasp{{600, 20}});
    edited.apply(edit::MoveTo{{610.25, 11.5}});
    EXPECT_EQ(edited.warp().corners[1], glm::dvec2(610.25, 11.5));
    edited.apply(edit::Release{});
    edited.apply(edit::Choose{Tool::Mesh});
    EXPECT_THAT(edited.apply(edit::Move{{1, 0}}), HasSubstr("there is no mesh"));
    edited.apply(edit::MeshPoints{{4, 3}});
    const glm::dvec2 point = *edited.editor.handles()[5].at;
    edited.apply(edit::Grasp{point + glm::dvec2(9, -4)});
    EXPECT_EQ(edited.editor.handle(), 5u);
    edited.apply(edit::MoveTo{point + glm::dvec2(20, 10)});
    EXPECT_LT(glm::distance(*edited.editor.handles()[5].at, point + glm::dvec2(20, 10)), 0.01);
    edited.apply(edit::Choose{Tool::Corners});
    edited.apply(edit::Grasp{*edited.editor.handles()[2].at});
    EXPECT_EQ(edited.editor.handle(), 2u);
}

// More points where the wall asks for them: what is set so far stays.
TEST(SiteEditor, a_finer_mesh_keeps_the_shape) {
    Edited edited;
    edited.apply(edit::Choose{Tool::Mesh});
    edited.apply(edit::MeshPoints{{3, 3}});
    edited.apply(edit::Handle{4});
    for (int i = 0; i < 9; ++i) edited.apply(edit::Move{{2, 1}});
    const Warp before = edited.editor.site().outputs[0].projection.warp;
    edited.apply(edit::MeshPoints{{5, 5}});
    const Warp& after = edited.editor.site().outputs[0].projection.warp;
    for (const glm::dvec2 at : {glm::dvec2(0.5, 0.5), {0.25, 0.5}, {0.75, 0.25}, {0, 1}})
        EXPECT_LT(glm::distance(before.projectorFromCanvas(at), after.projectorFromCanvas(at)), 0.02);
    edited.apply(edit::MeshPoints{});
    EXPECT_FALSE(edited.editor.site().outputs[0].projection.warp.bends());
}

TEST(SiteEditor, sets_light_and_the_part_of_the_canvas) {
    Edited edited;
    edited.apply(edit::Choose{Tool::Light});
    edited.apply(edit::Move{{0, 3}});  // down: less
    edited.apply(edit::Handle{1});
    edited.apply(edit::Move{{1, 0}});
    const ProjectorLight& light = edited.editor.site().outputs[0].projection.light;
    EXPECT_EQ(light.brightness, 0.97);
    EXPECT_EQ(light.gamma, 2.21);
    edited.apply(edit::Choose{Tool::Part});
    edited.apply(edit::Handle{2});
    edited.apply(edit::Move{{-45, 7}});  // an edge moves across itself alone
    EXPECT_EQ(edited.warp().part, (CanvasPart{{0, 0}, {0.955, 1}}));
    for (int i = 0; i < 3; ++i) edited.apply(edit::Move{{500, 0}});
    EXPECT_EQ(edited.warp().part.high.x, 1) << "the canvas ends there";
}

// A window that must stay dark: four corners, one more, moved together and one by one, and its edge
// softened.
TEST(SiteEditor, sets_masks_point_by_point_and_as_a_whole) {
    Edited edited;
    edited.apply(edit::Choose{Tool::Masks});
    EXPECT_THAT(edited.editor.handles()[0].label, "no mask");
    EXPECT_THAT(edited.apply(edit::Move{{1, 0}}), HasSubstr("there is no mask"));
    EXPECT_THAT(edited.apply(edit::MaskPoints{1}), HasSubstr("there is no mask"));
    edited.apply(edit::Choose{Tool::Corners});
    EXPECT_THAT(edited.apply(edit::TurnMask{}), HasSubstr("choose a mask first"));
    EXPECT_THAT(edited.apply(edit::MaskPoints{1}), HasSubstr("choose a mask first"));
    edited.apply(edit::AddMask{});
    EXPECT_EQ(edited.editor.tool(), Tool::Masks) << "what was added is what is moved next";
    edited.apply(edit::Move{{8, -3}});
    const auto masks = [&] { return edited.editor.site().outputs[0].projection.masks; };
    EXPECT_THAT(masks()[0].polygon,
                ElementsAre(glm::dvec2(168, 87), glm::dvec2(488, 87), glm::dvec2(488, 267), glm::dvec2(168, 267)));
    edited.apply(edit::Handle{1});  // its edge
    edited.apply(edit::Move{{0, -12}});
    EXPECT_EQ(masks()[0].feather, 12);
    edited.apply(edit::Grasp{{480, 90}});
    edited.apply(edit::MaskPoints{1});
    EXPECT_EQ(masks()[0].polygon[2], glm::dvec2(488, 177)) << "halfway to the next";
    edited.apply(edit::MoveTo{{520, 177}});
    EXPECT_EQ(masks()[0].polygon[2], glm::dvec2(520, 177)) << "the new one is chosen";
    edited.apply(edit::TurnMask{});
    EXPECT_TRUE(masks()[0].hidesOutside);
    EXPECT_TRUE(sameProjection(edited.savedAndRead().outputs[0].projection, edited.editor.site().outputs[0].projection));
    for (int i = 0; i < 3; ++i) edited.apply(edit::MaskPoints{-1});
    EXPECT_THAT(masks(), IsEmpty()) << "of three points none can go alone";
    EXPECT_THAT(edited.savedAndRead().outputs[0].projection.masks, IsEmpty());
    edited.apply(edit::Undo{});
    EXPECT_EQ(masks()[0].polygon.size(), 3u);
}

// A picture as a mask is the file's alone, and stays what and where it is when the mask before it
// goes and comes back.
TEST(SiteEditor, leaves_masks_that_are_pictures_alone) {
    Edited edited;
    const ScratchFolder& folder = edited.folder;
    ASSERT_TRUE(writePng(folder.path() / "trees.png", GreyImage(4, 4, 0.5f)));
    std::string text = kSite;
    text += R"(    masks:
      - polygon: [[0, 0], [9, 0], [0, 9]]  # the left window
      - image: trees.png  # drawn on Monday
      - {polygon: [[50, 50], [90, 50], [50, 90]], feather: 2}  # the lamp
)";
    text.replace(text.find("  - {name: right"), std::string::npos, text.substr(text.find("    masks:")));
    ASSERT_TRUE(writeFile(edited.file, text));
    edited.editor = SiteEditor(readSite(edited.file).value());
    edited.apply(edit::Choose{Tool::Masks});
    EXPECT_EQ(edited.editor.handles().size(), 10u) << "three points, the whole and the edge of two polygons";
    edited.apply(edit::MaskPoints{-1});
    EXPECT_EQ(edited.savedAndRead().outputs[0].projection.masks.size(), 2u);
    std::string wanted = text;
    const std::size_t first = wanted.find("      - polygon");
    wanted.erase(first, wanted.find('\n', first) + 1 - first);
    EXPECT_EQ(readFile(edited.file).value(), wanted);
    edited.apply(edit::Undo{});
    const std::vector<Mask> back = edited.savedAndRead().outputs[0].projection.masks,
                            set = edited.editor.site().outputs[0].projection.masks;
    ASSERT_EQ(back.size(), 3u);
    EXPECT_EQ(back[0], set[0]);
    EXPECT_EQ(back[1].imageFile, "trees.png");
    EXPECT_EQ(back[2], set[2]);
    edited.apply(edit::Reset{});
    const std::vector<Mask> reset = edited.savedAndRead().outputs[0].projection.masks;
    ASSERT_EQ(reset.size(), 1u);
    EXPECT_TRUE(reset[0].image);
}

// What cannot be projected is refused, with a reason, and the last good picture stays.
TEST(SiteEditor, refuses_what_could_not_be_projected_and_changes_nothing) {
    Edited edited;
    const Projection before = edited.editor.site().outputs[0].projection;
    edited.apply(edit::Handle{1});
    EXPECT_THAT(edited.apply(edit::MoveTo{{-500, 300}}), HasSubstr("crossed or folded"));
    edited.apply(edit::Handle{-2});
    EXPECT_THAT(edited.apply(edit::MoveTo{{9000, 9000}}), HasSubstr("nothing of the picture would be seen"));
    edited.apply(edit::Choose{Tool::Part});
    EXPECT_THAT(edited.apply(edit::Move{{5000, 0}}), HasSubstr("has no area"));
    EXPECT_THAT(edited.apply(edit::MeshPoints{{1, 5}}), HasSubstr("2 to 129 points"));
    EXPECT_THAT(edited.apply(edit::OutputNumber{2}), HasSubstr("no such output"));
    EXPECT_THAT(edited.apply(edit::Undo{}), HasSubstr("nothing to undo"));
    EXPECT_TRUE(sameProjection(before, edited.editor.site().outputs[0].projection));
    EXPECT_THAT(edited.editor.unsaved(), IsEmpty());
}

// A held arrow key is one thing to take back, and so is a drag; two presses are two.
TEST(SiteEditor, takes_back_a_movement_as_a_whole) {
    Edited edited;
    const auto before = edited.warp().corners;
    for (int i = 0; i < 30; ++i) edited.apply(edit::Move{{1, 0}});
    edited.apply(edit::Release{});
    edited.apply(edit::Move{{0, 1}});
    edited.apply(edit::Release{});
    edited.apply(edit::Undo{});
    EXPECT_EQ(edited.warp().corners[0], before[0] + glm::dvec2(30, 0));
    edited.apply(edit::Undo{});
    EXPECT_EQ(edited.warp().corners, before);
    edited.apply(edit::Redo{});
    edited.apply(edit::Redo{});
    EXPECT_EQ(edited.warp().corners[0], before[0] + glm::dvec2(30, 1));
    EXPECT_THAT(edited.apply(edit::Redo{}), HasSubstr("nothing to redo"));
    edited.apply(edit::Undo{});
    edited.apply(edit::Output{1});
    edited.apply(edit::Flip{});
    edited.apply(edit::Undo{});
    edited.apply(edit::Undo{});
    EXPECT_EQ(edited.editor.output(), 0u) << "what is taken back is shown where it happens";
}

TEST(SiteEditor, steps_through_the_test_pictures_and_back_to_the_show) {
    Edited edited;
    edited.apply(edit::Picture{1});
    EXPECT_EQ(edited.editor.picture(), TestPicture::Grid);
    edited.apply(edit::Picture{-2});
    EXPECT_EQ(edited.editor.picture(), TestPicture::Identify);
    edited.apply(edit::Picture{1});
    EXPECT_EQ(edited.editor.picture(), TestPicture::None);
    edited.apply(edit::Show{TestPicture::Ramp});
    EXPECT_EQ(edited.editor.picture(), TestPicture::Ramp);
}

TEST(SiteEditor, writes_what_has_changed_and_leaves_every_remark) {
    Edited edited;
    edited.apply(edit::Move{{0.5, 0}});
    edited.apply(edit::Output{1});
    edited.apply(edit::Turn{});
    edited.apply(edit::Turn{});
    edited.savedAndRead();
    std::string wanted = kSite;
    wanted.replace(wanted.find("[12, 8]"), 7, "[12.5, 8]");
    wanted.replace(wanted.find("refresh_rate: 30}"), 17, "refresh_rate: 30, turn: 180}");
    EXPECT_EQ(readFile(edited.file).value(), wanted);
    EXPECT_EQ(readFile(edited.file.string() + ".previous").value(), kSite);
    EXPECT_THAT(edited.editor.lines().back(), "saved");
}

// Whatever is done, in whatever order: each step can be saved and read back exactly, and all of it
// can be taken back.
TEST(SiteEditor, every_step_goes_through_the_file_and_back) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        Edited edited;
        const Site before = edited.editor.site();
        Rng rng(seed);
        int changes = 0;
        for (int step = 0; step < 120; ++step) {
            const double x = rng.uniform(-20, 20), y = rng.uniform(-20, 20);
            const int count = 2 + static_cast<int>(rng.below(4));
            const EditCommand commands[] = {edit::Output{1},
                                            edit::Choose{static_cast<Tool>(rng.below(5))},
                                            edit::Handle{static_cast<int>(rng.below(7)) - 3},
                                            edit::Grasp{{10 * x + 320, 8 * y + 180}},
                                            edit::Move{{x / 10, y / 10}},
                                            edit::Move{{x, 0}},
                                            edit::MoveTo{{20 * x + 320, 10 * y + 180}},
                                            edit::Release{},
                                            edit::StepSize{rng.below(2) == 0 ? 1 : -1},
                                            edit::MeshPoints{rng.below(4) == 0 ? glm::ivec2(0) : glm::ivec2(count, 3)},
                                            edit::AddMask{},
                                            edit::MaskPoints{rng.below(2) == 0 ? 1 : -1},
                                            edit::TurnMask{},
                                            edit::Flip{},
                                            edit::Turn{},
                                            edit::Reset{},
                                            edit::Picture{1}};
            const bool changed = edited.apply(commands[rng.below(std::size(commands))]).empty();
            if (!changed || edited.editor.unsaved().empty() || rng.below(3) != 0) continue;
            ++changes;
            const Site read = edited.savedAndRead();
            for (std::size_t i = 0; i < read.outputs.size(); ++i)
                ASSERT_TRUE(sameProjection(read.outputs[i].projection, edited.editor.site().outputs[i].projection))
                    << "seed " << seed << ", step " << step << ", output " << i << "\n"
                    << readFile(edited.file).value();
            const std::string text = readFile(edited.file).value();
            for (const char* remark : {"# the wall behind the church", "# on the tall ladder", "# measured on Friday",
                                       "# by its manual", "# behind the door"})
                ASSERT_THAT(text, HasSubstr(remark)) << "seed " << seed;
        }
        EXPECT_GT(changes, 10) << seed;
        while (edited.apply(edit::Undo{}).empty()) {
        }
        for (std::size_t i = 0; i < before.outputs.size(); ++i)
            EXPECT_TRUE(sameProjection(before.outputs[i].projection, edited.editor.site().outputs[i].projection)) << seed;
    }
}

}  // namespace
}  // namespace fantascope::show
