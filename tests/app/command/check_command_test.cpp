#include "app/command/check_command.h"

#include "pattern/shape/elemental_shape.h"
#include "pattern/shape/shape_pattern.h"
#include "show/replaced.h"
#include "theatre/body/body.h"
#include "theatre/stage/cast.h"
#include "theatre/stage/stage_file.h"

#include "core/file.h"
#include "media/image.h"
#include "scratch_folder.h"
#include "test_video.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <sstream>

namespace fantascope::app {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::string_view kSite = R"(fantascope: site
version: 1
outputs: [{name: left, display: {driver: headless}, size: [640, 360], refresh_rate: 30}]
universes: [{number: 1, port: {driver: simulated}}]
fixtures: [{name: lamp, universe: 1, address: 1, channels: [intensity]}]
)";

constexpr std::string_view kShow = R"(fantascope: show
version: 1
title: Test
sources: {dim: {solid: [0.1, 0.1, 0.1]}}
looks: {glow: {outputs: {left: [{source: dim}]}, fixtures: {lamp: 1}}}
cues: [{name: Glow, look: glow, fade: 1}, {name: Still, look: glow, fade: 1}]
)";

struct Checked {
    std::string lines;
    std::string refusal;  // "" if nothing was refused
};

Checked check(const ScratchFolder& folder, const CheckOptions& options) {
    std::ostringstream out;
    const auto done = checkFiles(options, out);
    return {folder.relative(out.str()), done ? "" : folder.relative(done.error().message())};
}

TEST(Check, says_of_each_good_file_what_it_holds) {
    const ScratchFolder folder;
    folder.file("show.yaml", kShow);
    const auto site = folder.file("site.yaml", kSite);
    const auto settings =
        folder.file("fine.pattern-settings.yaml", "fantascope: pattern-settings\nversion: 1\nshapes: {instances: 40}\n");
    const auto guide = folder.path() / "guide.png";
    ASSERT_TRUE(writePng(guide, GreyImage(64, 36)));
    const auto wanted = folder.file(
        "wanted.yaml", "fantascope: wanted\nversion: 1\noutputs: {left: {camera: [[0, 0], [9, 0], [9, 9], [0, 9]]}}\n");
    const Checked checked = check(folder, {{folder.path() / "show.yaml", site, settings, guide, wanted}, std::nullopt});
    EXPECT_EQ(checked.lines,
              "ok show.yaml: show, 2 cues, 1 look, 1 source, starts dark and waits for GO\n"
              "ok site.yaml: site, 1 output, 1 fixture, 0 relays\n"
              "ok fine.pattern-settings.yaml: pattern settings, at most 40 instances\n"
              "ok guide.png: guide, 64 x 36 px\n"
              "ok wanted.yaml: wanted places, 1 output\n");
    EXPECT_EQ(checked.refusal, "");
}

// Example failure: the technician patches a lamp, the artist forgets it, and it stays dark for
// thirty nights.
TEST(Check, notes_what_nobody_will_see) {
    const ScratchFolder folder;
    ASSERT_TRUE(writePng(folder / "huge.png", RgbaImage(1600, 900)));
    const auto site = folder.file("site.yaml", R"(fantascope: site
version: 1
outputs:
  - {name: left, display: {driver: headless}, size: [640, 360], refresh_rate: 30, canvas: wall, part: [0, 0, 0.45, 1], canvas_size: [4, 2.25]}
  - {name: right, display: {driver: headless}, size: [640, 360], refresh_rate: 30, canvas: wall, part: [0.5, 0, 1, 1]}
  - {name: roof, display: {driver: headless}, size: [640, 360], refresh_rate: 30}
universes: [{number: 1, port: {driver: simulated}}]
fixtures: [{name: lamp, universe: 1, address: 1, channels: [intensity]}, {name: bench, universe: 1, address: 2, channels: [intensity]}]
)");
    const auto show = folder.file("show.yaml", R"(fantascope: show
version: 2
title: Test
start: Glow
sources: {dim: {image: huge.png}, forgotten: {solid: [0.1, 0.1, 0.1]}}
looks: {glow: {outputs: {roof: [{source: dim}], wall: []}, fixtures: {lamp: 1}}, unused: {}}
cues: [{name: Before, look: glow, fade: 1}, {name: Glow, look: glow, fade: 1, wait: 5, follow: 4}, {name: Last, look: glow, fade: 1}]
)");
    const std::string lines = check(folder, {{show, site}, site}).lines;
    for (const char* const note :
         {"note: show.yaml:5:46: sources.forgotten: no look shows this source", "note: show.yaml: no cue has the look 'unused'",
          "note: show.yaml: the show starts with 'Glow', so GO never reaches the cue 'Before' before it",
          "note: show.yaml: the cue 'Glow' waits 5 s, and the next one follows after 4 s: nothing of it is seen",
          "note: show.yaml: no look names these things of site.yaml: fixture 'bench'; they stay dark",
          "its picture has 900 rows, and the canvas 'roof' 360: a smaller one looks the same",
          "note: site.yaml: no output shows the place [0.45, 0, 0.5, 1] of the canvas 'wall'; its parts leave a gap"})
        EXPECT_THAT(lines, HasSubstr(note));
    EXPECT_EQ(std::ranges::count(lines, '\n'), 10) << lines;
}

// Lists of the show, and buttons of the site for them.
TEST(Check, looks_into_every_list_and_for_the_lists_of_buttons) {
    const ScratchFolder folder;
    const std::string lists =
        "lists: {Bar: {start: b, cues: [{name: a, look: glow, fade: 1}, {name: b, look: warm, wait: 5, fade: 1, follow: 2}, "
        "{name: c, look: glow, fade: 1}]}}\ncues: ";
    std::string text = replaced(replaced(std::string(kShow), "version: 1", "version: 2"), "cues: ", lists);
    text = replaced(text, "looks: {", "looks: {warm: {fixtures: {lamp: 0.5}}, ");
    const auto show = folder.file("show.yaml", text);
    const auto site =
        folder.file("site.yaml", std::string(kSite) +
                                     "cue_controller: {device: {driver: simulated}, buttons: {go: 1, lists: {Bar: {go: 2}, "
                                     "Baar: {go: 3}}}}\n");
    const Checked checked = check(folder, {{show}, site});
    EXPECT_EQ(checked.refusal, "");
    EXPECT_THAT(checked.lines, HasSubstr("the show starts with 'b', so GO never reaches the cue 'a' before it"));
    EXPECT_THAT(checked.lines, HasSubstr("the cue 'b' waits 5 s, and the next one follows after 2 s"));
    EXPECT_THAT(checked.lines, HasSubstr("button 3 (go) is for the list 'Baar', which show.yaml does not have: it does nothing"));
    EXPECT_EQ(checked.lines.find("no cue has the look 'warm'"), std::string::npos) << "a list has it";
    EXPECT_EQ(checked.lines.find("'Bar', which"), std::string::npos);
}

TEST(Check, of_a_schedule_needs_the_site_s_place_and_notes_one_that_plays_nothing) {
    const ScratchFolder folder;
    const auto show = folder.file("show.yaml", replaced(std::string(kShow), "version: 1\ntitle: Test",
                                                        "version: 2\ntitle: Test\nstart: schedule\nschedule: {last: 2020-01-01, "
                                                        "nights: [{cue: Glow, from: sunset}]}"));
    const auto nowhere = folder.file("site.yaml", kSite);
    const Checked refused = check(folder, {{show}, nowhere});
    EXPECT_THAT(refused.lines,
                HasSubstr("show.yaml:5:11: schedule: a schedule needs to know where the show is: add 'place: {latitude"));
    const auto somewhere =
        folder.file("place.yaml", std::string(kSite) + "place: {latitude: 48, longitude: 16, time_zone: Europe/Vienna}\n");
    const Checked checked = check(folder, {{show}, somewhere});
    EXPECT_EQ(checked.refusal, "");
    EXPECT_THAT(checked.lines, HasSubstr("plays by its schedule"));
    EXPECT_THAT(checked.lines, HasSubstr("note: show.yaml:5:11: schedule: nothing plays within a year"));
}

TEST(Check, a_folder_stands_for_the_show_in_it) {
    const ScratchFolder folder;
    folder.file("show.yaml", kShow);
    EXPECT_THAT(check(folder, {{folder.path()}, std::nullopt}).lines, HasSubstr("show, 2 cues"));
}

// A show may be right in itself and still not fit the place. Example failure: the technician learns
// it at nightfall.
TEST(Check, a_show_is_held_against_the_site) {
    const ScratchFolder folder;
    const auto site = folder.file("site.yaml", kSite);
    const auto show = folder.file("show.yaml", kShow),
               other = folder.file("other.yaml", replaced(std::string(kShow), "lamp: 1", "lmap: 1"));
    const Checked fits = check(folder, {{show}, site});
    EXPECT_EQ(fits.lines,
              "ok site.yaml: site, 1 output, 1 fixture, 0 relays\n"
              "ok show.yaml: show, 2 cues, 1 look, 1 source, starts dark and waits for GO, plays on site.yaml\n");
    const Checked misses = check(folder, {{other}, site});
    EXPECT_THAT(misses.lines,
                HasSubstr("other.yaml:5:67: looks.glow.fixtures.lmap: no fixture is called 'lmap' (known: lamp) in site.yaml"));
    EXPECT_EQ(misses.refusal, "1 of 2 files refused");
}

// Example failure: the show loads, and one of its pictures stays black for want of a file.
TEST(Check, a_show_is_checked_with_the_patterns_and_guides_that_it_names) {
    const ScratchFolder folder;
    const auto patternFile = folder.path() / "leaves.pattern.yaml", guide = folder.path() / "leaves.png";
    pattern::ShapePattern pattern;
    pattern.guide = guide;
    pattern.width = 64;
    pattern.height = 36;
    pattern.shapes = {pattern::loadShape("triangle").value()};
    pattern.instances = {{.id = 0, .centre = {0.5, 0.5}, .size = 0.1}, {.id = 1, .centre = {1, 0.5}, .size = 0.1}};
    ASSERT_TRUE(writePng(guide, GreyImage(64, 36)));
    ASSERT_TRUE(pattern::writePattern(patternFile, pattern));
    const auto show =
        folder.file("show.yaml", replaced(std::string(kShow), "{solid: [0.1, 0.1, 0.1]}", "{pattern: leaves.pattern.yaml}"));
    EXPECT_EQ(check(folder, {{show}, std::nullopt}).lines,
              "ok show.yaml: show, 2 cues, 1 look, 1 source, starts dark and waits for GO\n"
              "ok leaves.pattern.yaml: pattern, 2 instances, 2 triangles\n"
              "ok leaves.png: guide, 64 x 36 px\n");
    std::filesystem::remove(guide);
    const Checked checked = check(folder, {{show}, std::nullopt});
    EXPECT_THAT(checked.lines, HasSubstr("\nleaves.pattern.yaml:3:8: guide: leaves.png: "));
    EXPECT_EQ(checked.refusal, "1 of 3 files refused");
}

// Example failure: a video that loops for ever is waited for all night.
TEST(Check, a_cue_can_wait_only_for_what_comes_to_an_end) {
    const ScratchFolder folder;
    writeVideo(folder.path() / "rain.mp4", {.rate = 30}, 60, [](int number) { return numbered({64, 64}, number); });
    const auto site = folder.file("site.yaml", kSite);
    const auto checked = [&](const std::string& video) {
        const auto show = folder.file("show.yaml", fmt::format(R"(fantascope: show
version: 2
title: Test
sources: {{rain: {{video: {}}}}}
looks: {{wet: {{outputs: {{left: [{{source: rain}}]}}}}}}
cues: [{{name: Wet, look: wet, fade: 0, follow: {{after_media: 1}}}}, {{name: Dry, look: wet, fade: 0}}]
)",
                                                               video));
        return check(folder, {{show}, site}).lines;
    };
    EXPECT_THAT(checked("rain.mp4"),
                HasSubstr("show.yaml:6:62: cues[0].follow.after_media: nothing that is seen in this cue comes "
                          "to an end; give its video 'times', or its shadow 'play: once'"));
    EXPECT_THAT(checked("{file: rain.mp4, times: 2}"), HasSubstr("ok show.yaml"));
}

TEST(Check, notes_a_play_that_changes_nothing) {
    const ScratchFolder folder;
    const auto show = folder.file("show.yaml", R"(fantascope: show
version: 2
title: Test
sources: {dim: {solid: [0.1, 0.1, 0.1]}, water: {caustics: {}}}
looks:
  glow: {outputs: {left: [{source: dim}, {source: water}]}}
  slow: {play: {dim: 0.5, water: {speed: 0.5, restart: true}}}
cues: [{name: Glow, look: glow, fade: 1}, {name: Slow, look: slow, fade: 1}]
)");
    const std::string lines = check(folder, {{show}, std::nullopt}).lines;
    EXPECT_THAT(lines, HasSubstr("note: show.yaml: the look 'slow' gives 'dim' a speed, but it does not move\n"));
    EXPECT_THAT(lines, HasSubstr("the look 'slow' lets 'water' begin again, but only videos and shadows do\n"));
    EXPECT_THAT(lines, Not(HasSubstr("gives 'water'")));
}

// Example failure: the show loads, and the projector stays dark since the video was copied by
// halves.
TEST(Check, a_show_is_checked_with_its_images_and_videos) {
    const ScratchFolder folder;
    const auto video = folder.path() / "rain.mp4", image = folder.path() / "poster.png";
    writeVideo(video, {.rate = 30}, 60, [](int number) { return numbered({64, 64}, number); });
    ASSERT_TRUE(writePng(image, RgbaImage(64, 36)));
    const auto show =
        folder.file("show.yaml", replaced(std::string(kShow), "dim: {solid: [0.1, 0.1, 0.1]}",
                                          "dim: {video: rain.mp4}, poster: {image: poster.png}, wall: {camera: {}}"));
    EXPECT_EQ(check(folder, {{show}, std::nullopt}).lines,
              "ok show.yaml: show, 2 cues, 1 look, 3 sources, starts dark and waits for GO\n"
              "   note: show.yaml:4:43: sources.poster: no look shows this source\n"
              "   note: show.yaml:4:70: sources.wall: no look shows this source\n"
              "ok rain.mp4: video, 64 x 64 px, 60 frames, 2.00 s, h264\n"
              "ok poster.png: guide, 64 x 36 px\n");
    const std::string bytes = readFile(video).value();
    folder.file("rain.mp4", bytes.substr(0, bytes.size() / 2));
    const Checked checked = check(folder, {{show}, std::nullopt});
    EXPECT_THAT(checked.lines,
                HasSubstr("\nshow.yaml:4:24: sources.dim.video: rain.mp4: not a video that can be read, or a truncated one"));
    EXPECT_EQ(checked.refusal, "1 of 3 files refused");

    const auto site = folder.file("site.yaml", kSite);
    EXPECT_THAT(check(folder, {{show}, site}).lines, HasSubstr("show.yaml:4:70: sources.wall: site.yaml has no camera"));
}

TEST(Check, a_shape_is_checked_as_a_pattern_would_take_it) {
    const ScratchFolder folder;
    const auto drawing = folder.file(
                   "a.svg", "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'><path d='M1 1 h6 v3 h-6 z'/></svg>"),
               empty = folder.file("b.SVG", "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 9 9'/>"),
               floor = folder.file("c.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n"),
               settings = folder.file(
                   "s.yaml", "fantascope: pattern-settings\nversion: 1\nshapes: {each: [{file: a.svg}, {builtin: leaf}]}\n"),
               broken = folder.file("t.yaml", "fantascope: pattern-settings\nversion: 1\nshapes: {each: [{file: b.SVG}]}\n");
    const Checked checked = check(folder, {{drawing, empty, floor, settings, broken}, std::nullopt});
    EXPECT_THAT(checked.lines, HasSubstr("ok a.svg: elemental shape, 2 triangles\n"));
    EXPECT_THAT(checked.lines, HasSubstr("\nb.SVG: draws nothing that has an area"));
    EXPECT_THAT(checked.lines, HasSubstr("\nc.obj: has no area seen from the front"));
    EXPECT_THAT(checked.lines, HasSubstr("\nok s.yaml: pattern settings, at most 1000 instances, 2 shapes\n"));
    EXPECT_THAT(checked.lines, HasSubstr("\nt.yaml:3:24: shapes.each[0].file: b.SVG: draws nothing"));
    EXPECT_EQ(checked.refusal, "3 of 5 files refused");
}

// Example failure: a motion's handle outside the drawing is found by whoever has an hour less.
TEST(Check, what_the_theatre_reads_is_checked_as_it_would_be_read) {
    const ScratchFolder folder;
    GreyImage bar(80, 60);
    for (int y = 10; y < 50; ++y)
        for (int x = 30; x < 50; ++x) bar.at(x, y) = 1;
    for (const char* file : {"bar.png", "one.png", "two.png"}) ASSERT_TRUE(writePng(folder / file, bar));
    ASSERT_TRUE(writePng(folder / "other.png", GreyImage(60, 60, 1.0f)));
    const std::string motion =
                          "fantascope: motion\nversion: 1\nseconds: 1.3\nloop: true\nhandles:\n  - {name: a, at: [0.5, 0.7]}\n",
                      sequence = "fantascope: sequence\nversion: 1\nframes_per_second: 10\npictures: [one.png, two.png]\n",
                      stage =
                          "fantascope: stage\nversion: 1\nlight: [0, 0, 7]\nprops:\n"
                          "  - {name: rod, mesh: rod.obj, held_by: {actor: 1, part: head}}\n",
                      hints = "fantascope: hints\nversion: 1\nhints:\n  - {name: a, at: [0.5, 0.7], prop: rod}\n";
    folder.file("rod.obj", "v 0 0 0\nv 0.3 0 0\nv 0 0.3 0\nv 0 0 0.3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    const Checked good = check(
        folder, {{folder.file("bar.motion.yaml", motion), folder.file("free.motion.yaml", motion),
                  folder.file("moves.yaml", sequence), folder.file("bar.stage.yaml", stage), folder.file("bar.hints.yaml", hints),
                  folder.file("w.yaml", "fantascope: pose-weights\nversion: 1\ncommon: {w1: 0.02}\n")},
                 std::nullopt});
    EXPECT_EQ(good.lines,
              "ok bar.motion.yaml: motion, 1 handle, 1.3 s, 12 frames a second, loops\n"
              "ok free.motion.yaml: motion, 1 handle, 1.3 s, 12 frames a second, loops; there is no free.png to say whether its "
              "points are in the white\n"
              "ok moves.yaml: sequence, 2 frames, 80 x 60 px, 10 a second\n"
              "ok bar.stage.yaml: stage, light, 0 platforms, 1 prop\n"
              "ok bar.hints.yaml: hints, 1 point\n"
              "ok w.yaml: pose weights\n");

    const Checked bad = check(folder, {{folder.file("bar.motion.yaml", replaced(motion, "0.5, 0.7", "0.1, 0.7")),
                                        folder.file("moves.yaml", replaced(sequence, "two", "other")),
                                        folder.file("bar.stage.yaml", replaced(stage, "rod.obj", "r.obj")),
                                        folder.file("w.yaml", "fantascope: pose-weights\nversion: 1\ncommon: {w17: 1}\n")},
                                       std::nullopt});
    EXPECT_THAT(bad.lines, HasSubstr("bar.motion.yaml:6:19: handles[0].at: handle 'a' is 22 pixels outside the white"));
    EXPECT_THAT(bad.lines, HasSubstr("other.png is 60 x 60 pixels, and the first picture 80 x 60"));
    EXPECT_THAT(bad.lines, HasSubstr("bar.stage.yaml:5:23: props[0].mesh:"));
    EXPECT_THAT(bad.lines, HasSubstr("w.yaml:3:10: common.w17: unknown key"));
    EXPECT_EQ(bad.refusal, "4 of 4 files refused");
}

// Example failure: an animal comes out 1.8 times too wide, and nobody was told.
TEST(Check, a_source_of_another_shape_than_its_canvas_is_noted_with_both_shapes_and_its_fit) {
    const ScratchFolder folder;
    ASSERT_TRUE(writePng(folder / "square.png", RgbaImage(64, 64)));
    ASSERT_TRUE(writePng(folder / "wide.png", RgbaImage(64, 36)));
    const auto site = folder.file("site.yaml", kSite);
    const auto noted = [&](const std::string& sources) {
        const auto show = folder.file("show.yaml", replaced(std::string(kShow), "dim: {solid: [0.1, 0.1, 0.1]}", sources));
        return check(folder, {{show}, site}).lines;
    };
    EXPECT_THAT(
        noted("dim: {image: square.png}"),
        HasSubstr(
            "note: show.yaml:4:16: sources.dim: its picture is 1.00 : 1, and the canvas 'left' is 1.78 : 1: all of it is seen, "
            "with dark beside it (fit: contain)\n"));
    EXPECT_THAT(noted("dim: {image: square.png, fit: cover}"), HasSubstr("what hangs over the canvas is cut off (fit: cover)"));
    EXPECT_THAT(noted("dim: {image: square.png, fit: stretch}"), HasSubstr("circles become ellipses (fit: stretch)"));
    for (const char* fine : {"dim: {image: wide.png}", "dim: {solid: [0, 0, 0]}"})
        EXPECT_THAT(noted(fine), testing::Not(HasSubstr("note:"))) << fine;
    EXPECT_THAT(noted("dim: {image: wide.png, fit: fill}"),
                HasSubstr("sources.dim.fit: one of contain, cover, stretch is needed"));
}

// Example failure: pictures are fitted to a shape that the canvas has in the projector only.
TEST(Check, a_canvas_of_unknown_shape_is_noted_with_what_to_measure) {
    const ScratchFolder folder;
    ASSERT_TRUE(writePng(folder / "square.png", RgbaImage(64, 64)));
    const auto show = folder.file("show.yaml", replaced(std::string(kShow), "solid: [0.1, 0.1, 0.1]", "image: square.png"));
    const std::string keystoned = "size: [640, 360], corners: [[123, 48], [545, 45], [538, 325], [128, 283]]";
    const auto noted = [&](const std::string& size) {
        return check(folder, {{show}, folder.file("site.yaml", replaced(std::string(kSite), "size: [640, 360]", size))}).lines;
    };
    EXPECT_THAT(noted(keystoned),
                HasSubstr("note: site.yaml: the corners of 'left' do not tell the shape of the canvas 'left' on the wall"));
    EXPECT_THAT(noted(keystoned), HasSubstr("canvas_size: [WIDTH, HEIGHT]"));
    EXPECT_THAT(noted(keystoned + ", canvas_size: [2, 2]"), testing::Not(HasSubstr("note:")));
}

// Example failure: a show that plays at a site without a camera is refused for the lack of a
// drawing that nobody looks at.
TEST(Check, a_missing_drawing_is_a_fault_only_where_a_camera_compares_with_it) {
    const ScratchFolder folder;
    pattern::ShapePattern pattern;
    pattern.width = 64;
    pattern.height = 36;
    pattern.shapes = {pattern::loadShape("triangle").value()};
    pattern.instances = {{.id = 0, .centre = {0.5, 0.5}, .size = 0.1}};
    pattern.guide = folder / "guide.png";
    ASSERT_TRUE(writePng(pattern.guide, GreyImage(64, 36)));
    ASSERT_TRUE(pattern::writePattern(folder / "deer.pattern.yaml", pattern));
    std::filesystem::remove(pattern.guide);
    const auto show =
        folder.file("show.yaml", replaced(std::string(kShow), "solid: [0.1, 0.1, 0.1]", "pattern: deer.pattern.yaml"));
    const std::string camera =
        "camera: {device: {driver: simulated}, size: [64, 36], field_of_view: 60, position: [0, 1, 9], look_at: [0, 1, 0]}\n";
    const Checked plays = check(folder, {{show}, folder.file("site.yaml", kSite)});
    EXPECT_EQ(plays.refusal, "");
    EXPECT_THAT(plays.lines, HasSubstr("note: deer.pattern.yaml:"));
    EXPECT_THAT(plays.lines, HasSubstr("guide.png: is missing; without a camera the show plays all the same"));
    EXPECT_NE(check(folder, {{show}, std::nullopt}).refusal, "") << "any site may have one";
    EXPECT_NE(check(folder, {{show}, folder.file("watched.yaml", std::string(kSite) + camera)}).refusal, "");
}

// Leaves that were made as light shade what is to be light. Example failure: a deer of light on a
// dark wall becomes a dark deer.
TEST(Check, leaves_that_show_the_drawings_negative_are_noted_with_what_makes_them_right) {
    const ScratchFolder folder;
    pattern::ShapePattern pattern;
    pattern.width = 64;
    pattern.height = 36;
    pattern.shapes = {pattern::loadShape("triangle").value()};
    pattern.instances = {{.id = 0, .centre = {0.5, 0.5}, .size = 0.1}};
    const auto noted = [&](const char* guide, const char* layer) {
        pattern.guide = folder / guide;
        FANTASCOPE_CHECK(writePng(pattern.guide, GreyImage(64, 36)).has_value(), "the guide is there");
        FANTASCOPE_CHECK(pattern::writePattern(folder / "deer.pattern.yaml", pattern).has_value(), "the pattern is there");
        const auto show = folder.file("show.yaml", replaced(std::string(kShow), "solid: [0.1, 0.1, 0.1]",
                                                            "foliage: {height: 3, layers: [{" + std::string(layer) +
                                                                ": deer.pattern.yaml, distance: 1}]}"));
        return check(folder, {{show}, std::nullopt}).lines;
    };
    EXPECT_THAT(noted("deer.png", "leaves"), HasSubstr("'fantascope pattern GUIDE -o deer.pattern.yaml --shadows'"));
    EXPECT_THAT(noted("deer.shadows.png", "holes"), HasSubstr("make them without --shadows"));
    EXPECT_THAT(noted("deer.shadows.png", "leaves"), testing::Not(HasSubstr("note:")));
    EXPECT_THAT(noted("deer.png", "holes"), testing::Not(HasSubstr("note:")));
}

TEST(Check, a_drawing_in_ink_on_paper_is_noted) {
    const ScratchFolder folder;
    GreyImage drawing(64, 36, 1.0f);
    for (int x = 20; x < 40; ++x) drawing.at(x, 18) = 0;
    ASSERT_TRUE(writePng(folder / "ink.png", drawing));
    EXPECT_THAT(check(folder, {{folder / "ink.png"}, std::nullopt}).lines, HasSubstr("looks like dark ink on white paper"));
}

// With what it names: a cast's target, its stage, and the silhouette that it follows.
TEST(Check, a_cast_is_checked_with_what_it_is_of) {
    const ScratchFolder folder;
    ASSERT_TRUE(writePng(folder / "t.png", GreyImage(80, 60)));
    folder.file("s.yaml", "fantascope: sequence\nversion: 1\nframes_per_second: 10\npictures: [t.png, t.png]\n");
    folder.file("a.stage.yaml", "fantascope: stage\nversion: 1\nlight: [0, 0, 7]\n");
    const theatre::Body body = theatre::humanBody(1.7);
    const theatre::ActorPose pose = theatre::poseOf(body, body.restPose({0, 1, 2}, {1, 0, 0, 0}));
    theatre::Cast cast{
        {{folder / "t.png", 1.7}}, theatre::readStage(folder / "a.stage.yaml").value(), folder / "a.stage.yaml", 10, 1,
        {{1.7, {pose, pose}}},     theatre::Cast::Sequence{folder / "s.yaml", 0, 0}};
    ASSERT_TRUE(theatre::writeCast(folder / "c.cast.yaml", cast));
    EXPECT_EQ(check(folder, {{folder / "c.cast.yaml"}, std::nullopt}).lines,
              "ok c.cast.yaml: cast, 1 actor, 2 frames, 10 a second, 1.7 m high\n"
              "ok t.png: guide, 80 x 60 px\n"
              "ok a.stage.yaml: stage, light, 0 platforms, 0 props\n"
              "ok s.yaml: sequence, 2 frames, 80 x 60 px, 10 a second\n");
}

// One mistake does not hide the next file's.
TEST(Check, goes_on_after_a_refusal_and_counts_them) {
    const ScratchFolder folder;
    const auto truncated = folder.path() / "truncated.png";
    ASSERT_TRUE(writePng(truncated, GreyImage(64, 36, 0.5f)));
    const std::string png = readFile(truncated).value();
    folder.file("truncated.png", png.substr(0, png.size() / 2));
    const Checked checked = check(folder, {{folder.file("a.yaml", "fantascope: shoe\n"), folder.file("b.yaml", "version: 1\n"),
                                            truncated, folder.path() / "absent.yaml", folder.file("site.yaml", kSite)},
                                           std::nullopt});
    std::istringstream lines(checked.lines);
    std::string line;
    for (const std::string expected :
         {"a.yaml:1:13: fantascope: one of ", "b.yaml:1:1: 'fantascope' is missing: the kind of file, one of show, site, pattern",
          "truncated.png: ", "absent.yaml: cannot be read: No such file or directory", "ok site.yaml: "}) {
        ASSERT_TRUE(std::getline(lines, line));
        EXPECT_THAT(line, testing::StartsWith(expected));
    }
    EXPECT_EQ(checked.refusal, "4 of 5 files refused");
}

TEST(Check, a_file_that_is_named_twice_is_read_once) {
    const ScratchFolder folder;
    const auto site = folder.file("site.yaml", kSite);
    const Checked checked = check(folder, {{site, folder.path() / "." / "site.yaml"}, site});
    EXPECT_EQ(checked.lines, "ok site.yaml: site, 1 output, 1 fixture, 0 relays\n");
}

}  // namespace
}  // namespace fantascope::app
