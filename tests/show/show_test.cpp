#include "show/show.h"

#include "show/play/journal.h"
#include "show/replaced.h"

#include "core/geometry.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::string_view kShow = R"(fantascope: show
version: 1
title: Test
sources:
  leaves: {pattern: patterns/leaves.pattern.yaml}
  dim: {solid: [0.1, 0.2, 0.3]}
looks:
  dark: {}
  bright:
    outputs:
      left: [{source: leaves, opacity: 0.5}, {source: dim}]
    fixtures: {fountain: {blue: 0.75}, sculpture: 1}
    relays: {road: off}
cues:
  - {name: Dusk, look: dark, fade: 2}
  - {name: Night, look: bright, fade: 1.5, follow: 20}
  - {name: Farewell, look: dark, fade: 0}
)";

// Two outputs, two fixtures of four channels, a lamp that is safe when on and a fog machine that is
// safe when off.
Site testSite() {
    Site site;
    site.file = "site.yaml";
    site.outputs.resize(2);
    site.outputs[0].name = site.outputs[0].canvas = "right";
    site.outputs[1].name = site.outputs[1].canvas = "left";
    site.fixtures = {{"sculpture", 1, 1, {"intensity"}}, {"fountain", 1, 2, {"red", "green", "blue"}}};
    site.relays = {{"fog", 0, 0, false}, {"road", 0, 1, true}};
    return site;
}

struct Loaded {
    ScratchFolder folder;
    Result<Show> show = Error("not loaded");

    explicit Loaded(const std::string& text) {
        folder.file("patterns/leaves.pattern.yaml", "");
        show = Show::load(folder.file("show.yaml", text));
    }
};

std::string refusal(const std::string& text) {
    const Loaded loaded(text);
    return loaded.show ? "accepted" : loaded.folder.relative(loaded.show.error().message());
}
std::string refusalAfter(std::string_view what, std::string_view by) { return refusal(replaced(std::string(kShow), what, by)); }

std::string bindRefusalAfter(std::string_view what, std::string_view by) {
    const Loaded loaded(replaced(std::string(kShow), what, by));
    if (!loaded.show) return "not loaded: " + loaded.show.error().message();
    const auto list = loaded.show->bind(testSite());
    return list ? "bound" : loaded.folder.relative(list.error().message());
}

TEST(ShowFile, reads_everything_that_the_file_says) {
    const Loaded loaded{std::string(kShow)};
    ASSERT_TRUE(loaded.show) << loaded.show.error().message();
    const Show& show = *loaded.show;
    EXPECT_EQ(show.title, "Test");
    EXPECT_EQ(show.goInterval, 300ms);
    EXPECT_EQ(show.blackoutFade, 300ms);
    ASSERT_EQ(show.sources.size(), 2u);
    EXPECT_EQ(std::get<PatternSource>(show.sources[0].picture).file, loaded.folder.path() / "patterns/leaves.pattern.yaml");
    EXPECT_EQ(std::get<SolidSource>(show.sources[1].picture).colour, glm::vec3(0.1f, 0.2f, 0.3f));
    ASSERT_EQ(show.cues.size(), 3u);
    EXPECT_EQ(show.cues[1].name, "Night");
    EXPECT_EQ(show.looks[show.cues[1].look].name, "bright");
    EXPECT_EQ(show.cues[1].fade, 1500ms);
    EXPECT_EQ(show.cues[1].follow, 20s);
    EXPECT_EQ(show.cues[0].follow, std::nullopt);
}

TEST(ShowFile, a_folder_stands_for_the_show_in_it) {
    const Loaded loaded{std::string(kShow)};
    EXPECT_EQ(Show::load(loaded.folder.path())->title, "Test");
    EXPECT_THAT(Show::load(loaded.folder.path() / "patterns").error().message(),
                EndsWith("patterns/show.yaml: cannot be read: No such file or directory"));
}

TEST(ShowFile, a_panic_has_a_fade_of_its_own_since_version_2) {
    EXPECT_EQ(Loaded(std::string(kShow)).show->panicFade, 2s);
    const std::string slow = replaced(std::string(kShow), "title: Test", "title: Test\npanic_fade: 5");
    EXPECT_FALSE(Loaded(slow).show);
    const Loaded loaded(replaced(slow, "version: 1", "version: 2"));
    ASSERT_TRUE(loaded.show) << loaded.show.error().message();
    EXPECT_EQ(loaded.show->panicFade, 5s);
}

TEST(ShowFile, own_go_interval_and_blackout_fade_replace_the_defaults) {
    const Loaded loaded(replaced(std::string(kShow), "title: Test", "title: Test\ngo_interval: 1\nblackout_fade: 0"));
    EXPECT_EQ(loaded.show->goInterval, 1s);
    EXPECT_EQ(loaded.show->blackoutFade, 0s);
}

TEST(ShowFile, mistakes_are_refused_with_place_and_advice) {
    EXPECT_EQ(refusalAfter("title:", "tittle:"), "show.yaml:3:1: tittle: unknown key (did you mean 'title'?)");
    EXPECT_EQ(refusalAfter("opacity: 0.5", "opacty: 0.5"),
              "show.yaml:11:31: looks.bright.outputs.left[0].opacty: unknown key (did you mean 'opacity'?)");
    EXPECT_EQ(refusalAfter("fade: 2}", "fade: slow}"),
              "show.yaml:15:36: cues[0].fade: a number in 0 .. 3600 s is needed, here is 'slow'");
    EXPECT_EQ(refusalAfter("fade: 2}", "fade: -2}"), "show.yaml:15:36: cues[0].fade: -2 is out of range, 0 .. 3600 s is allowed");
    EXPECT_EQ(refusalAfter("opacity: 0.5", "opacity: 50"),
              "show.yaml:11:40: looks.bright.outputs.left[0].opacity: 50 is out of range, 0 .. 1 is allowed");
    EXPECT_EQ(refusalAfter("blue: 0.75", "blue: 255"),
              "show.yaml:12:33: looks.bright.fixtures.fountain.blue: 255 is out of range, 0 .. 1 is allowed");
    EXPECT_EQ(refusalAfter("road: off", "road: 0"),
              "show.yaml:13:20: looks.bright.relays.road: one of off, on is needed, here is '0'");
    EXPECT_EQ(refusalAfter("look: bright", "look: brigth"),
              "show.yaml:16:25: cues[1].look: one of dark, bright is needed, here is 'brigth' (did you mean 'bright'?)");
    EXPECT_EQ(refusalAfter("source: dim", "source: dimm"),
              "show.yaml:11:55: looks.bright.outputs.left[1].source: one of leaves, dim is needed, here is 'dimm' (did you mean "
              "'dim'?)");
    EXPECT_EQ(refusalAfter("version: 1", "version: 3"),
              "show.yaml:2:10: version: version 3 was written by a newer program, this one reads up to 2; update it");
}

TEST(ShowFile, pattern_files_are_there_and_inside_the_show) {
    EXPECT_EQ(refusalAfter("patterns/leaves.pattern.yaml", "patterns/leafs.pattern.yaml"),
              "show.yaml:5:21: sources.leaves.pattern: there is no file patterns/leafs.pattern.yaml; make it with 'fantascope "
              "pattern GUIDE -o "
              "patterns/leafs.pattern.yaml'");
    EXPECT_EQ(refusalAfter("patterns/leaves.pattern.yaml", "/srv/leaves.pattern.yaml"),
              "show.yaml:5:21: sources.leaves.pattern: '/srv/leaves.pattern.yaml' is absolute; name it relative to this file's "
              "folder, so "
              "that the whole folder can move");
    EXPECT_EQ(
        refusalAfter("patterns/leaves.pattern.yaml", "../leaves.pattern.yaml"),
        "show.yaml:5:21: sources.leaves.pattern: '../leaves.pattern.yaml' leaves this file's folder; copy the file into it");
}

TEST(ShowFile, a_source_is_of_exactly_one_kind) {
    const std::string_view kinds = "{solid: [0.1, 0.2, 0.3]}";
    const std::string answer =
        "show.yaml:6:8: sources.dim: exactly one kind of source is needed: 'pattern', 'solid', "
        "'foliage', 'caustics', 'mirror_ball', 'image', 'video', 'camera' or 'shadow'";
    EXPECT_EQ(refusalAfter(kinds, "{}"), answer);
    EXPECT_EQ(refusalAfter(kinds, "{solid: [0, 0, 0], pattern: patterns/leaves.pattern.yaml}"), answer);
    EXPECT_THAT(refusalAfter(kinds, "{solid: [0, 0]}"), HasSubstr("sources.dim.solid: a list of exactly 3 items is needed"));
}

std::string foliage(const std::string& keys,
                    const std::string& layers = "[{leaves: patterns/leaves.pattern.yaml, distance: 6}]") {
    return "{foliage: {height: 3, " + keys + "layers: " + layers + "}}";
}

// Angles are degrees in the file and radians inside; what is not said has its default.
TEST(ShowFile, foliage_has_layers_at_their_distances) {
    const std::string_view solid = "{solid: [0.1, 0.2, 0.3]}";
    Loaded loaded(replaced(std::string(kShow), solid,
                           foliage("sun: 2, light: [1, 0.9, 0.5], ",
                                   "[{leaves: patterns/leaves.pattern.yaml, distance: 6}, {holes: patterns/leaves.pattern.yaml, "
                                   "distance: 9, filter: patterns/leaves.pattern.yaml}]")));
    ASSERT_TRUE(loaded.show) << loaded.show.error().message();
    const auto& source = std::get<FoliageSource>(loaded.show->sources[1].picture);
    EXPECT_EQ(source.height, 3);
    EXPECT_EQ(source.sun, radians(2));
    EXPECT_EQ(source.light, glm::dvec3(1, 0.9, 0.5));
    EXPECT_EQ(source.shadow, glm::dvec3(0));
    ASSERT_EQ(source.layers.size(), 2u);
    EXPECT_FALSE(source.layers[0].holes);
    EXPECT_EQ(source.layers[0].filter, std::nullopt);
    EXPECT_EQ(source.layers[0].distance, 6);
    EXPECT_TRUE(source.layers[1].holes);
    EXPECT_TRUE(source.layers[1].filter.has_value());
    EXPECT_THAT(filesOf(loaded.show->sources[1]), testing::SizeIs(2));

    const Loaded bare(replaced(std::string(kShow), solid, foliage("")));
    EXPECT_EQ(std::get<FoliageSource>(bare.show->sources[1].picture).sun, radians(0.53));
}

TEST(ShowFile, foliage_that_cannot_be_is_refused) {
    const std::string_view solid = "{solid: [0.1, 0.2, 0.3]}";
    EXPECT_THAT(refusalAfter(solid, foliage("", "[]")), HasSubstr("foliage.layers: a list of"));
    EXPECT_THAT(refusalAfter(solid, foliage("", "[{distance: 3}]")), HasSubstr("exactly one of 'leaves' and 'holes' is needed"));
    EXPECT_THAT(refusalAfter(solid, foliage("", "[{leaves: no.yaml, distance: 3}]")), HasSubstr("there is no file no.yaml"));
    EXPECT_THAT(refusalAfter(solid, foliage("", "[{leaves: patterns/leaves.pattern.yaml, distance: 3, filter: sun.png}]")),
                HasSubstr("there is no file sun.png; it is a picture"));
    EXPECT_THAT(refusalAfter(solid, foliage("sun: 50, ")),
                HasSubstr("layers[0]: from 6 m away the sun is blurred over 2.4 times"));
    EXPECT_THAT(refusalAfter(solid, foliage("sunn: 1, ")), HasSubstr("unknown key (did you mean 'sun'?)"));
}

// The one-line forms are whole, and impossible places are refused.
TEST(ShowFile, water_and_mirrors_need_no_numbers) {
    const std::string_view solid = "{solid: [0.1, 0.2, 0.3]}";
    const Loaded both(
        replaced(std::string(kShow), "dim: {solid: [0.1, 0.2, 0.3]}", "dim: {caustics: {}}\n  ball: {mirror_ball: {}}"));
    ASSERT_TRUE(both.show) << both.show.error().message();
    EXPECT_TRUE(std::holds_alternative<CausticsSource>(both.show->sources[1].picture));
    EXPECT_TRUE(std::holds_alternative<MirrorBallSource>(both.show->sources[2].picture));
    EXPECT_THAT(refusalAfter(solid, "{caustics: {wave_length: 0.01}}"), HasSubstr("too short to be seen"));
    EXPECT_THAT(refusalAfter(solid, "{caustics: {wave_height: 0.3}}"), HasSubstr("too steep"));
    EXPECT_THAT(refusalAfter(solid, "{caustics: {depth: 900}}"), HasSubstr("scatters the light all over"));
    EXPECT_THAT(refusalAfter(solid, "{mirror_ball: {ball: [0, 0, 0.1]}}"), HasSubstr("must be in front of the wall"));
    EXPECT_THAT(refusalAfter(solid, "{mirror_ball: {lamp: [0, 0.5, 2.2]}}"), HasSubstr("inside the ball"));
    EXPECT_THAT(refusalAfter(solid, "{mirror_ball: {facet: 0.001}}"), HasSubstr("has mirrors of 0.005 m to 0.25 m"));
    EXPECT_THAT(refusalAfter(solid, "{mirror_ball: {turn: 0}}"), HasSubstr("a turn takes at least a second"));
}

TEST(ShowFile, shadow_theatre_is_a_cast_with_its_lamps) {
    const std::string_view solid = "{solid: [0.1, 0.2, 0.3]}";
    const std::string file = "patterns/leaves.pattern.yaml";  // what is in it is not looked at here
    const Loaded both(
        replaced(std::string(kShow), "dim: {solid: [0.1, 0.2, 0.3]}",
                 fmt::format("dim: {{shadow: {0}}}\n"
                             "  soft: {{shadow: {{cast: {0}, light: [1, 0.5, 0], actors: [[0, 0, 1]], size: 0.2, samples: 4,\n"
                             "    lamps: [{{at: [1, 2, 3], shadow: [0, 0, 0.1]}}], play: to_and_fro, speed: 2,\n"
                             "    picture: {{x: [-1, 2], y: [0, 1.5]}}}}}}",
                             file)));
    ASSERT_TRUE(both.show) << both.show.error().message();
    const auto& plain = std::get<ShadowSource>(both.show->sources[1].picture);
    EXPECT_EQ(plain.cast, both.folder / file);
    ASSERT_EQ(plain.lamps.size(), 1u);
    EXPECT_FALSE(plain.lamps[0].at || plain.play || plain.picture);
    EXPECT_EQ(plain.lamps[0].light, glm::dvec3(1));
    EXPECT_THAT(filesOf(both.show->sources[1]), ElementsAre(both.folder / file));
    const auto& soft = std::get<ShadowSource>(both.show->sources[2].picture);
    ASSERT_EQ(soft.lamps.size(), 2u);
    EXPECT_EQ(soft.lamps[0].light, glm::dvec3(1, 0.5, 0));
    EXPECT_EQ(soft.lamps[0].size, 0.2);
    EXPECT_THAT(soft.lamps[0].actors, ElementsAre(glm::dvec3(0, 0, 1)));
    EXPECT_EQ(soft.lamps[1].at, glm::dvec3(1, 2, 3));
    EXPECT_EQ(soft.lamps[1].shadow, glm::dvec3(0, 0, 0.1));
    EXPECT_EQ(soft.samples, 4);
    EXPECT_EQ(soft.play, ShadowSource::Play::ToAndFro);
    EXPECT_EQ(soft.speed, 2);
    ASSERT_TRUE(soft.picture);
    EXPECT_EQ(soft.picture->x, glm::dvec2(-1, 2));
    EXPECT_THAT(refusalAfter(solid, "{shadow: nobody.cast.yaml}"), HasSubstr("make it with 'fantascope pose SILHOUETTE.png'"));
    const auto with = [&](const std::string& key) {
        return refusalAfter(solid, fmt::format("{{shadow: {{cast: {}, {}}}}}", file, key));
    };
    EXPECT_THAT(with("beam: 0"), HasSubstr("1 .. 8"));
    EXPECT_THAT(with("lamps: [{size: 0.1}]"), HasSubstr("'at' is missing"));
    EXPECT_THAT(with("picture: {x: [2, -1], y: [0, 1]}"), HasSubstr("the smaller number comes first"));
    EXPECT_THAT(with("samples: 0"), HasSubstr("1 .. 128"));
    EXPECT_THAT(with("play: twice"), HasSubstr("to_and_fro"));
    EXPECT_THAT(with("shadows: 2"), HasSubstr("unknown key"));
}

TEST(ShowFile, pictures_and_videos_are_files_and_a_camera_is_none) {
    const std::string_view solid = "dim: {solid: [0.1, 0.2, 0.3]}";
    const std::string file = "patterns/leaves.pattern.yaml";  // what is in it is not looked at here
    const Loaded loaded(
        replaced(std::string(kShow), solid,
                 fmt::format("dim: {{image: {0}}}\n  rain: {{video: {0}}}\n"
                             "  snow: {{video: {{file: {0}, loop: false, speed: 0.5}}}}\n  wall: {{camera: {{}}}}",
                             file)));
    ASSERT_TRUE(loaded.show) << loaded.show.error().message();
    const auto& sources = loaded.show->sources;
    EXPECT_EQ(std::get<ImageSource>(sources[1].picture).file, loaded.folder / file);
    EXPECT_EQ(std::get<VideoSource>(sources[2].picture).times, 0);
    EXPECT_EQ(std::get<VideoSource>(sources[2].picture).speed, 1);
    EXPECT_EQ(std::get<VideoSource>(sources[3].picture).times, 1);
    EXPECT_EQ(std::get<VideoSource>(sources[3].picture).speed, 0.5);
    EXPECT_TRUE(std::holds_alternative<CameraSource>(sources[4].picture));
    const Loaded part(replaced(std::string(kShow), solid,
                               fmt::format("dim: {{video: {{file: {}, from: 2.5, to: 4, times: 3, at_end: dark}}}}", file)));
    ASSERT_TRUE(part.show) << part.show.error().message();
    EXPECT_EQ(std::get<VideoSource>(part.show->sources[1].picture),
              (VideoSource{.file = part.folder / file, .from = 2500ms, .to = 4s, .times = 3, .endsDark = true}));
    for (const std::size_t named : {1u, 2u, 3u}) EXPECT_THAT(filesOf(sources[named]), ElementsAre(loaded.folder / file));

    const auto refused = [&](const std::string& source) { return refusalAfter("{solid: [0.1, 0.2, 0.3]}", source); };
    EXPECT_THAT(refused("{image: no.png}"), HasSubstr("image: there is no file no.png; it is a picture (PNG, JPEG or TIFF)"));
    EXPECT_THAT(refused("{video: no.mp4}"), HasSubstr("video: there is no file no.mp4; it is a video"));
    EXPECT_THAT(refused("{video: {loop: true}}"), HasSubstr("'file' is missing"));
    EXPECT_THAT(refused("{video: {file: patterns/leaves.pattern.yaml, speed: 0}}"), HasSubstr("speed: "));
    const auto refusedVideo = [&](const std::string& keys) {
        return refused("{video: {file: patterns/leaves.pattern.yaml, " + keys + "}}");
    };
    EXPECT_THAT(refusedVideo("from: 3, to: 3"), HasSubstr("'to' comes after 'from'"));
    EXPECT_THAT(refusedVideo("loop: true, times: 2"), HasSubstr("give one of 'loop' and 'times'"));
    EXPECT_THAT(refusedVideo("at_end: dark"), HasSubstr("this video has no end; add 'times', or remove 'at_end'"));
    EXPECT_THAT(refusedVideo("times: 0"), HasSubstr("times"));
    EXPECT_THAT(refused("{camera: {size: 3}}"), HasSubstr("unknown key"));
    EXPECT_THAT(refused("{camera: {}, image: patterns/leaves.pattern.yaml}"), HasSubstr("exactly one kind of source"));
}

// Fades match layers by their source: with two of one, which goes where would be a guess.
TEST(ShowFile, a_source_stands_on_an_output_once) {
    EXPECT_EQ(
        refusalAfter("{source: dim}", "{source: leaves}"),
        "show.yaml:11:46: looks.bright.outputs.left[1]: 'leaves' is on this output already; one layer of a source is enough");
}

TEST(ShowFile, cues_have_their_own_names_and_the_last_does_not_follow) {
    EXPECT_EQ(refusalAfter("name: Night", "name: Dusk"),
              "show.yaml:16:5: cues[1]: another cue is called 'Dusk'; each needs its own name");
    EXPECT_EQ(refusalAfter("fade: 0}", "fade: 0, follow: 3}"),
              "show.yaml:17:5: cues[2]: no cue comes after this one; remove its 'follow'");
    EXPECT_EQ(refusal(std::string(kShow.substr(0, kShow.find("cues:"))) + "cues: []\n"),
              "show.yaml:14:7: cues: a list of at least 1 items is needed, here are 0");
}

TEST(ShowFile, cues_are_found_by_name) {
    const Loaded loaded{std::string(kShow)};
    EXPECT_EQ(*loaded.show->cueNamed("Night"), 1u);
    EXPECT_EQ(loaded.folder.relative(loaded.show->cueNamed("night").error().message()),
              "show.yaml: no cue is called 'night' (did you mean 'Night'?)");
    EXPECT_THAT(loaded.show->cueNamed("Intermission").error().message(), EndsWith("(known: Dusk, Night, Farewell)"));
}

// Playback, renderer and patch count; names are for people. Example failure: levels in the order of
// the show file.
TEST(ShowBind, puts_looks_in_the_sites_order) {
    const Loaded loaded{std::string(kShow)};
    const auto list = loaded.show->bind(testSite());
    ASSERT_TRUE(list) << list.error().message();
    const Look& night = list->cues[1].look;
    EXPECT_TRUE(night.outputs[0].layers.empty());
    EXPECT_THAT(night.outputs[1].layers, ElementsAre(LayerState{0, 0.5f}, LayerState{1, 1.0f}));
    EXPECT_THAT(night.levels, ElementsAre(1.0f, 0.0f, 0.0f, 0.75f));
    EXPECT_THAT(night.relays, ElementsAre(0, 0));
    EXPECT_EQ(list->cues[1].fade, 1500ms);
    EXPECT_EQ(list->cues[1].follow, 20s);
    EXPECT_EQ(list->goInterval, 300ms);
    EXPECT_EQ(list->blackoutFade, 300ms);
}

// What a look leaves out does not linger from the cue before. Example failure: a street lamp that
// stays off after the show.
TEST(ShowBind, what_a_look_does_not_name_is_dark_and_safe) {
    const Loaded loaded{std::string(kShow)};
    const auto list = loaded.show->bind(testSite());
    const Look safe{{{}, {}}, {0, 0, 0, 0}, {0, 1}};  // fog off, road lamp on
    EXPECT_EQ(list->dark, safe);
    EXPECT_EQ(list->cues[2].look, safe);
}

TEST(ShowBind, one_level_goes_to_all_channels) {
    const Loaded loaded(replaced(std::string(kShow), "{blue: 0.75}", "0.5"));
    EXPECT_THAT(loaded.show->bind(testSite())->cues[1].look.levels, ElementsAre(1.0f, 0.5f, 0.5f, 0.5f));
}

TEST(ShowBind, names_that_the_site_does_not_have_are_refused_with_place_and_the_nearest_name) {
    EXPECT_EQ(bindRefusalAfter("left: [", "lefd: ["),
              "show.yaml:11:13: looks.bright.outputs.lefd: no output is called 'lefd' (did you mean 'left'?) in site.yaml");
    EXPECT_EQ(bindRefusalAfter("left: [", "ceiling: ["),
              "show.yaml:11:16: looks.bright.outputs.ceiling: no output is called 'ceiling' (known: right, left) in site.yaml");
    EXPECT_EQ(bindRefusalAfter("sculpture: 1", "sculptur: 1"),
              "show.yaml:12:50: looks.bright.fixtures.sculptur: no fixture is called 'sculptur' (did you mean 'sculpture'?) in "
              "site.yaml");
    EXPECT_EQ(bindRefusalAfter("blue: 0.75", "bleu: 0.75"),
              "show.yaml:12:33: looks.bright.fixtures.fountain.bleu: no channel of 'fountain' is called 'bleu' (known: red, "
              "green, blue) in site.yaml");
    EXPECT_EQ(bindRefusalAfter("road: off", "raod: off"),
              "show.yaml:13:20: looks.bright.relays.raod: no relay is called 'raod' (known: fog, road) in site.yaml");
    Site bare = testSite();
    bare.relays.clear();
    const Loaded loaded{std::string(kShow)};
    EXPECT_THAT(loaded.show->bind(bare).error().message(),
                EndsWith("no relay is called 'road' (there is none at all) in site.yaml"));
}

// Several projectors on one wall show one picture; an output may still have its own.
TEST(ShowBind, a_canvas_stands_for_all_of_its_outputs_and_an_outputs_own_layers_go_before) {
    Site site = testSite();
    site.outputs.resize(3);
    site.outputs[2].name = "middle";
    for (Output& output : site.outputs) output.canvas = "wall";
    const Loaded loaded(replaced(std::string(kShow), "left: [{source: leaves, opacity: 0.5}, {source: dim}]",
                                 "left: [{source: dim}]\n      wall: {layers: [{source: leaves}], wind: {strength: 3}}"));
    ASSERT_TRUE(loaded.show) << loaded.show.error().message();
    const auto list = loaded.show->bind(site);
    ASSERT_TRUE(list) << list.error().message();
    const Look& look = list->cues[1].look;
    EXPECT_THAT(look.outputs[0].layers, ElementsAre(LayerState{0, 1.0f}));
    EXPECT_THAT(look.outputs[1].layers, ElementsAre(LayerState{1, 1.0f}));
    EXPECT_THAT(look.outputs[2].layers, ElementsAre(LayerState{0, 1.0f}));
    EXPECT_EQ(list->cues[1].winds[2].strength, 3);
    const Loaded wrong(replaced(std::string(kShow), "left: [", "wal: ["));
    EXPECT_THAT(wrong.show->bind(site).error().message(),
                HasSubstr("no output or canvas is called 'wal' (did you mean 'wall'?)"));
}

TEST(ShowBind, layers_that_do_more_than_add_make_a_picture_in_their_order) {
    const Loaded loaded(replaced(std::string(kShow), "{source: dim}]", "{source: dim, blend: multiply}]"));
    ASSERT_TRUE(loaded.show) << loaded.show.error().message();
    const auto list = loaded.show->bind(testSite());
    const OutputState& left = list->cues[1].look.outputs[1];
    EXPECT_THAT(left.layers, ElementsAre(LayerState{0, 0.5f}, LayerState{1, 1.0f, Blend::Multiply}));
    EXPECT_THAT(left.pictures, ElementsAre(ComposedPicture{0, 2, 1.0f}));
    EXPECT_EQ(refusalAfter("{source: dim}]", "{source: dim, blend: multply}]"),
              "show.yaml:11:67: looks.bright.outputs.left[1].blend: one of add, over, multiply, screen is needed, here is "
              "'multply' (did you mean 'multiply'?)");
}

// Example failure: the wind of the one output that has its own is everybody's, or goes by the
// show's order instead of the site's.
TEST(ShowBind, gives_each_output_its_own_wind_or_that_of_the_look) {
    const Loaded loaded(replaced(
        replaced(std::string(kShow), "  bright:\n", "  bright:\n    wind: {strength: 2, gusts: 0.25, direction: 90}\n"),
        "left: [{source: leaves, opacity: 0.5}, {source: dim}]", "left: {layers: [{source: leaves}], wind: {strength: 0.5}}"));
    ASSERT_TRUE(loaded.show) << loaded.show.error().message();
    const auto list = loaded.show->bind(testSite());
    ASSERT_TRUE(list) << list.error().message();
    const std::vector<WindWish>&dark = list->cues[0].winds, &bright = list->cues[1].winds;
    ASSERT_EQ(bright.size(), 2u);
    EXPECT_EQ(bright[0].strength, 2);
    EXPECT_EQ(bright[0].gusts, 0.25);
    EXPECT_EQ(bright[0].direction, radians(90));
    EXPECT_EQ(bright[1].strength, 0.5);
    EXPECT_EQ(bright[1].gusts, 0);
    EXPECT_EQ(bright[1].direction, std::nullopt);
    for (const WindWish& wind : dark) EXPECT_EQ(wind.strength, 1);
    EXPECT_THAT(list->cues[1].look.outputs[1].layers, ElementsAre(LayerState{0, 1.0f}));
}

TEST(ShowFile, a_wind_out_of_its_range_is_refused) {
    const auto refusalOf = [](const std::string& wind) {
        return refusalAfter("  bright:\n", "  bright:\n    wind: " + wind + "\n");
    };
    EXPECT_EQ(refusalOf("{strength: 5}"), "show.yaml:10:22: looks.bright.wind.strength: 5 is out of range, 0 .. 4 is allowed");
    EXPECT_THAT(refusalOf("{gusts: -0.1}"), HasSubstr("looks.bright.wind.gusts: -0.1 is out of range, 0 .. 1"));
    EXPECT_THAT(refusalOf("{direction: 400}"), HasSubstr("-360 .. 360 degrees"));
    EXPECT_THAT(refusalOf("{strenght: 1}"), HasSubstr("did you mean 'strength'?"));
}

// The show of version 2, in which a cue changes what its look names.
constexpr std::string_view kTrackedShow = R"(fantascope: show
version: 2
title: Test
sources:
  leaves: {pattern: patterns/leaves.pattern.yaml}
  dim: {solid: [0.1, 0.2, 0.3]}
looks:
  dusk:
    wind: {strength: 2}
    outputs: {left: [{source: leaves}], right: {layers: [{source: dim}], wind: {strength: 3}}}
    fixtures: {fountain: {red: 0.25, blue: 0.75}, sculpture: 1}
    relays: {road: off}
  left alone:
    outputs: {left: [{source: dim}]}
    fixtures: {fountain: {red: 0.5}}
  black:
    outputs: {left: []}
    wind: {strength: 0.5}
  nothing: {}
cues:
  - {name: Dusk, look: dusk, fade: 2}
  - {name: Left, look: left alone, fade: 1, follow: 20}
  - {name: Black, look: black, fade: 1}
  - {name: Anew, look: left alone, fade: 0, block: true}
  - {name: Rest, look: nothing, fade: 0}
)";

std::string trackedRefusal(std::string_view what, std::string_view by) {
    return refusal(replaced(std::string(kTrackedShow), what, by));
}

TEST(TrackedShow, keeps_what_a_cue_does_not_mention) {
    const Loaded loaded{std::string(kTrackedShow)};
    ASSERT_TRUE(loaded.show) << loaded.show.error().message();
    const auto list = loaded.show->bind(testSite());
    ASSERT_TRUE(list) << list.error().message();
    const LayerState leaves{0, 1.0f}, dim{1, 1.0f};
    const auto& cues = list->cues;  // outputs: right, left; channels: sculpture, fountain's red, green, blue; relays: fog, road
    EXPECT_EQ(cues[0].look, (Look{{{{dim}}, {{leaves}}}, {1, 0.25f, 0, 0.75f}, {0, 0}}));
    EXPECT_EQ(cues[1].look, (Look{{{{dim}}, {{dim}}}, {1, 0.5f, 0, 0.75f}, {0, 0}})) << "green and blue, right and road stay";
    EXPECT_EQ(cues[2].look, (Look{{{{dim}}, {}}, {1, 0.5f, 0, 0.75f}, {0, 0}})) << "an empty list is black";
    EXPECT_EQ(cues[3].look, (Look{{{}, {{dim}}}, {0, 0.5f, 0, 0}, {0, 1}})) << "a cue that blocks begins with the dark";
    EXPECT_EQ(cues[4].look, cues[3].look);
    const auto strengths = [&](std::size_t cue) { return std::pair(cues[cue].winds[0].strength, cues[cue].winds[1].strength); };
    EXPECT_EQ(strengths(0), std::pair(3.0, 2.0));
    EXPECT_EQ(strengths(1), std::pair(3.0, 2.0));
    EXPECT_EQ(strengths(2), std::pair(0.5, 0.5));
    EXPECT_EQ(strengths(3), std::pair(1.0, 1.0));
    EXPECT_EQ(cues[1].follow, 20s);
    EXPECT_FALSE(cues[0].follow) << "nothing of the cue itself is kept";
}

// The migration that docs/show-format.md tells. Example failure: a show of version 1 plays
// otherwise than before.
TEST(TrackedShow, in_which_each_cue_blocks_is_that_of_version_1) {
    const Loaded before{std::string(kShow)};
    std::string text = replaced(std::string(kShow), "version: 1", "version: 2");
    for (const char* name : {"Dusk", "Night", "Farewell"})
        text = replaced(text, fmt::format("name: {},", name), fmt::format("name: {}, block: true,", name));
    const Loaded after{text};
    ASSERT_TRUE(after.show) << after.show.error().message();
    const CueList one = *before.show->bind(testSite()), two = *after.show->bind(testSite());
    ASSERT_EQ(one.cues.size(), two.cues.size());
    for (std::size_t i = 0; i < one.cues.size(); ++i) {
        EXPECT_EQ(one.cues[i].look, two.cues[i].look) << i;
        EXPECT_EQ(one.cues[i].fade, two.cues[i].fade) << i;
        EXPECT_EQ(one.cues[i].follow, two.cues[i].follow) << i;
    }
    EXPECT_FALSE(before.show->start);
    EXPECT_FALSE(before.show->loops);
    EXPECT_FALSE(one.loops);
}

// Example failures: a part that takes the cue's wait for its own; a fixture of which one channel
// moves; a follow after the fade that forgets the longest part.
TEST(TrackedShow, moves_the_parts_of_a_cue_in_their_own_time) {
    const Loaded loaded{replaced(std::string(kTrackedShow), "{name: Left, look: left alone, fade: 1, follow: 20}", R"(
    name: Left
    number: 1.5
    note: after the bell
    look: left alone
    wait: 2
    fade: {in: 1, out: 4, curve: smooth}
    follow: {after_fade: 3}
    parts:
      - {outputs: [left], fixtures: [fountain], wait: 0.5}
      - {sources: [dim], outputs: [right], relays: [road], fade: 8})")};
    ASSERT_TRUE(loaded.show) << loaded.show.error().message();
    const Show& show = *loaded.show;
    EXPECT_EQ(show.cues[1].note, "after the bell");
    std::vector<std::string> numbers;
    for (const Cue& cue : show.cues) numbers.push_back(textOf(cue.number));
    EXPECT_THAT(numbers, ElementsAre("1", "1.5", "2", "3", "4")) << "the next whole number";
    EXPECT_EQ(*show.cueNamed("1.5"), 1u);
    EXPECT_EQ(*show.cueNamed("Left"), 1u);
    EXPECT_FALSE(show.cueNamed("1.50")) << "as it is written";

    const auto list = show.bind(testSite());
    ASSERT_TRUE(list) << list.error().message();
    const CueList::Cue& cue = list->cues[1];
    EXPECT_EQ(cue.wait, 2s);
    EXPECT_EQ(cue.fade, Fade(1s, 4s, Curve::Smooth));
    EXPECT_EQ(cue.length(), 10s) << "the relay's part: two seconds, and eight";
    EXPECT_EQ(cue.follow, 13s);
    EXPECT_EQ(cue.firstWait(), 500ms);
    ASSERT_EQ(cue.parts.size(), 2u);
    EXPECT_EQ(cue.parts[0].wait, 500ms);
    EXPECT_EQ(cue.parts[0].fade, cue.fade);
    EXPECT_THAT(cue.parts[0].outputs, ElementsAre(1u)) << "left is the site's second";
    EXPECT_THAT(cue.parts[0].levels, ElementsAre(1u, 2u, 3u));
    EXPECT_EQ(cue.parts[1].wait, 2s);
    EXPECT_EQ(cue.parts[1].fade, Fade(8s));
    EXPECT_THAT(cue.parts[1].relays, ElementsAre(1u));
    ASSERT_EQ(cue.parts[1].layers.size(), 1u);
    EXPECT_EQ(cue.parts[1].layers[0].output, 0u);
    EXPECT_EQ(cue.parts[1].layers[0].source, SourceId{1});
    EXPECT_TRUE(list->cues[2].parts.empty()) << "parts do not track";
}

TEST(TrackedShow, refuses_parts_and_numbers_that_make_no_sense) {
    const auto partsRefusal = [](const std::string& parts) {
        return trackedRefusal("look: left alone, fade: 1, follow: 20", "look: left alone, fade: 1, parts: " + parts);
    };
    EXPECT_EQ(partsRefusal("[{wait: 1}]"),
              "show.yaml:22:53: cues[1].parts[0]: this part names nothing; add 'outputs', 'sources', 'fixtures' or 'relays'");
    EXPECT_THAT(partsRefusal("[{outputs: [left]}]"), HasSubstr("moves as the rest of its cue does; add a 'wait' or a 'fade'"));
    EXPECT_THAT(partsRefusal("[{sources: [dimm], wait: 1}]"), HasSubstr("did you mean 'dim'?"));
    EXPECT_THAT(trackedRefusal("name: Black,", "name: Black, number: 2,"), HasSubstr("cue 2 comes after cue 2; numbers go up"));
    EXPECT_THAT(trackedRefusal("name: Black,", "name: Black, number: 2.0005,"), HasSubstr("at most three decimal places"));
    EXPECT_THAT(trackedRefusal("version: 2", "version: 1"), HasSubstr("'block' needs 'version: 2'"));
    EXPECT_THAT(refusalAfter("fade: 1.5", "fade: {in: 1, out: 2}"), HasSubstr("'in' needs 'version: 2'"));

    const auto faultOf = [](const std::string& parts, std::string_view blend = "add") {
        const std::string text = replaced(std::string(kTrackedShow), "fade: 1, follow: 20", "fade: 1, parts: " + parts);
        const Loaded loaded{replaced(text, "left: [{source: dim}]", fmt::format("left: [{{source: dim, blend: {}}}]", blend))};
        EXPECT_TRUE(loaded.show) << loaded.show.error().message();
        const auto list = loaded.show->bind(testSite());
        return list ? "" : list.error().message();
    };
    EXPECT_THAT(faultOf("[{outputs: [lefd], wait: 1}]"), HasSubstr("did you mean 'left'?"));
    EXPECT_THAT(faultOf("[{relays: [raod], wait: 1}]"), HasSubstr("no relay is called 'raod' (known: fog, road)"));
    EXPECT_THAT(faultOf("[{outputs: [left], wait: 1}, {fixtures: [fountain], outputs: [left], fade: 2}]"),
                HasSubstr("cues[1].parts[1]: this part names what it or another part of the cue names already"));
    EXPECT_EQ(faultOf("[{outputs: [left], wait: 1}, {outputs: [left], sources: [dim], wait: 2}]"), "")
        << "a layer may leave its output alone";
    EXPECT_THAT(faultOf("[{sources: [dim], wait: 1}]", "over"), HasSubstr("composed in order, so they move together"));
}

TEST(TrackedShow, may_start_and_loop_by_itself) {
    const auto with = [](std::string_view keys, bool allFollow) {
        std::string text = replaced(std::string(kTrackedShow), "cues:\n", std::string(keys) + "cues:\n");
        if (allFollow)
            for (const char* last : {"look: dusk, ", "look: black, ", "look: nothing, "})
                text = replaced(text, last, std::string(last) + "follow: 5, ");
        if (allFollow) text = replaced(text, "block: true", "block: true, follow: 5");
        return text;
    };
    const Loaded waits(with("start: Left\n", false)), plays(with("start: Dusk\nat_end: loop\n", true)),
        dark(with("start: dark\nat_end: stay\n", false));
    ASSERT_TRUE(waits.show && plays.show && dark.show)
        << (waits.show ? plays.show ? dark.show.error() : plays.show.error() : waits.show.error()).message();
    EXPECT_EQ(waits.show->start, 1u);
    EXPECT_FALSE(waits.show->needsNoGoFrom(1));
    EXPECT_TRUE(waits.show->needsNoGoFrom(4)) << "nothing comes after the last cue";
    EXPECT_THAT(waits.show->beginning(), HasSubstr("waits for GO later"));
    EXPECT_EQ(plays.show->start, 0u);
    EXPECT_TRUE(plays.show->needsNoGoFrom(0));
    EXPECT_TRUE(plays.show->bind(testSite())->loops);
    // Example failure: a cue before the start, which is never reached, counts.
    const Loaded late(with("start: Anew\n", false));
    ASSERT_TRUE(late.show) << late.show.error().message();
    EXPECT_FALSE(late.show->needsNoGoFrom(3));
    Show last = *late.show;
    last.cues[3].follow = 5s;
    EXPECT_TRUE(last.needsNoGoFrom(3));
    EXPECT_EQ(last.beginning(), "starts with 'Anew' and plays by itself to its end");
    EXPECT_FALSE(dark.show->start);
    EXPECT_FALSE(dark.show->loops);
}

TEST(TrackedShow, may_follow_in_loops) {
    const auto with = [](std::string_view follow) {
        return replaced(std::string(kTrackedShow), "follow: 20", "follow: " + std::string(follow));
    };
    const Loaded loaded(with("{after_fade: 3, to: [Dusk, Anew], times: 4}"));
    ASSERT_TRUE(loaded.show) << loaded.show.error().message();
    const Cue& left = loaded.show->cues[1];
    EXPECT_EQ(left.follow, left.length() + 3s);
    EXPECT_THAT(left.followers, ElementsAre(0, 3));
    EXPECT_EQ(left.times, 4);
    const CueList list = loaded.show->bind(testSite()).value();
    EXPECT_EQ(list.cues[1].followers, left.followers);
    EXPECT_EQ(list.cues[1].times, 4);
    EXPECT_NE(hashOf(list), hashOf(Loaded(with("{after_fade: 3, to: [Anew, Dusk], times: 4}")).show->bind(testSite()).value()));

    const auto refusal = [&](std::string_view follow) { return Loaded(with(follow)).show.error().message(); };
    EXPECT_THAT(refusal("{after: 3, to: Duks}"), HasSubstr("follow.to: one of"));
    EXPECT_THAT(refusal("{to: Dusk}"), HasSubstr("give one of 'after', 'after_fade' and 'after_media'"));
    EXPECT_THAT(refusal("{after: 3, times: 2}"), HasSubstr("'times' counts how often 'to' follows"));
    EXPECT_THAT(refusal("{after: 0.05, to: Left}"), HasSubstr("follow each other in a circle in less than 0.1 s"));
}

// Example failure: a speed does not track, or a restart does.
TEST(TrackedShow, says_how_its_sources_play) {
    const auto with = [](std::string_view play) {
        const std::string text = replaced(std::string(kTrackedShow), "follow: 20", "follow: {after_media: 2, to: Dusk}");
        const std::string played = replaced(text, "\n  black:", fmt::format("\n    play: {}\n  black:", play));
        return replaced(played, "look: nothing, fade: 0", "look: nothing, fade: 0, block: true");
    };
    const Loaded loaded(with("{dim: 0.5, leaves: {restart: true}}"));
    ASSERT_TRUE(loaded.show) << loaded.show.error().message();
    const SourceId dim = loaded.show->sources[1].id, leaves = loaded.show->sources[0].id;
    PlayLengths lengths;
    lengths.add(dim, 7s);
    const CueList list = loaded.show->bind(testSite(), &lengths).value();
    EXPECT_EQ(list.cues[0].speedOf(dim), 1);
    EXPECT_EQ(list.cues[1].speedOf(dim), 0.5f);
    EXPECT_THAT(list.cues[1].restarts, ElementsAre(leaves));
    EXPECT_EQ(list.cues[1].usualFollow(), 16s);
    EXPECT_EQ(list.cues[2].speedOf(dim), 0.5f);
    EXPECT_THAT(list.cues[2].restarts, IsEmpty());
    EXPECT_EQ(list.cues[4].speedOf(dim), 1) << "it blocks";
    const CueList shorter = loaded.show->bind(testSite()).value();
    EXPECT_NE(hashOf(list), hashOf(shorter)) << "a journal must not be taken for exact";
    EXPECT_EQ(shorter.cues[1].usualFollow(), 3s) << "lengths that nobody knows are none";
    EXPECT_THAT(loaded.show->bind(testSite(), &lengths)->cues[1].endings,
                ElementsAre(testing::Field(&CueList::Cue::Ending::length, 7s)));
    const PlayLengths none;
    EXPECT_THAT(loaded.show->bind(testSite(), &none).error().message(),
                HasSubstr("follow.after_media: nothing that is seen in this cue comes to an end"));

    const auto refusal = [&](std::string_view play) { return Loaded(with(play)).show.error().message(); };
    EXPECT_THAT(refusal("{leafs: 1}"), HasSubstr("no source is called 'leafs'"));
    EXPECT_THAT(refusal("{dim: 11}"), HasSubstr("play.dim: 11 is out of range, 0 .. 10 is allowed"));
    EXPECT_THAT(refusal("{dim: {sped: 1}}"), HasSubstr("did you mean 'speed'?"));
    EXPECT_THAT(Loaded(replaced(with("{dim: 1}"), "version: 2", "version: 1")).show.error().message(),
                HasSubstr("needs 'version: 2'"));
}

TEST(TrackedShow, may_play_by_a_schedule) {
    const auto with = [](std::string_view keys) {
        return replaced(std::string(kTrackedShow), "cues:\n", std::string(keys) + "cues:\n");
    };
    constexpr const char* kNights = "schedule: {fade: 7, nights: [{cue: Left, from: \"22:00\"}]}\n";
    const Loaded loaded(with(std::string("start: schedule\n") + kNights));
    ASSERT_TRUE(loaded.show) << loaded.show.error().message();
    EXPECT_FALSE(loaded.show->start);
    ASSERT_TRUE(loaded.show->schedule);
    EXPECT_EQ(loaded.show->schedule->items[0].cue, 1u);
    EXPECT_EQ(loaded.show->bind(testSite())->darkFade, 7s);
    EXPECT_EQ(loaded.show->beginning(), "plays by its schedule");

    const auto refusal = [&](std::string_view keys) { return Loaded(with(keys)).show.error().message(); };
    EXPECT_THAT(refusal("start: schedule\n"), HasSubstr("'start: schedule' needs the key 'schedule'"));
    EXPECT_THAT(refusal(kNights), HasSubstr("schedule: this show does not play by its schedule; add 'start: schedule'"));
    EXPECT_THAT(refusal(std::string("start: Left\n") + kNights), HasSubstr("add 'start: schedule'"));
}

TEST(TrackedShow, is_refused_with_advice) {
    EXPECT_THAT(refusalAfter("cues:\n", "start: Night\ncues:\n"), HasSubstr("start: 'start' needs 'version: 2' in this file"));
    EXPECT_THAT(refusalAfter("fade: 0}", "fade: 0, block: true}"), HasSubstr("'block' needs 'version: 2'"));
    EXPECT_THAT(trackedRefusal("cues:\n", "start: Dsk\ncues:\n"), HasSubstr("did you mean 'Dusk'?"));
    EXPECT_THAT(trackedRefusal("cues:\n", "at_end: lop\ncues:\n"), HasSubstr("did you mean 'loop'?"));
    EXPECT_THAT(trackedRefusal("name: Rest", "name: dark"), testing::Eq("accepted"));
    EXPECT_THAT(
        refusal(replaced(replaced(std::string(kTrackedShow), "name: Rest", "name: dark"), "cues:\n", "start: dark\ncues:\n")),
        HasSubstr("rename the cue"));
    EXPECT_THAT(trackedRefusal("look: nothing, fade: 0", "look: nothing, fade: 0, follow: 3"),
                HasSubstr("no cue comes after this one; remove its 'follow', or add 'at_end: loop' to the show"));
    std::string endless = replaced(std::string(kTrackedShow), "follow: 20", "follow: 0");
    for (const char* last : {"look: dusk, ", "look: black, ", "look: nothing, "})
        endless = replaced(endless, last, std::string(last) + "follow: 0, ");
    endless = replaced(replaced(endless, "block: true", "block: true, follow: 0"), "cues:\n", "at_end: loop\ncues:\n");
    EXPECT_THAT(refusal(endless), HasSubstr("would never end"));
    // A mistake in a cue is told once, not again for 'start'.
    EXPECT_EQ(refusal(replaced(replaced(std::string(kTrackedShow), "fade: 2}", "fade: -2}"), "cues:\n", "start: Dusk\ncues:\n")),
              "show.yaml:22:36: cues[0].fade: -2 is out of range, 0 .. 3600 s is allowed");
}

}  // namespace
}  // namespace fantascope::show
