#include "show/site/site.h"

#include "show/patch.h"
#include "show/replaced.h"

#include "scratch_folder.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <numbers>

namespace fantascope::show {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr std::string_view kSite = R"(fantascope: site
version: 1
outputs:
  - name: left
    display: {driver: headless, colour: red}
    size: [640, 360]
    refresh_rate: 30
    corners: [[10, 0], [640, 20], [630, 360], [0, 350]]
    projector: {position: [0, 4, 9], look_at: [0, 1, 0], throw_ratio: 1.4}
    surface: {point: [0, 0, 0], normal: [0, 0, 0.5]}
  - {name: right, display: {driver: glfw}, size: [1920, 1080], refresh_rate: 59.94}
universes:
  - {number: 1, port: {driver: simulated}, desk: {device: {driver: sacn}, merge: ltp, own_priority: 90, settling: 2}}
  - {number: 7, port: {driver: artnet, address: 10.0.0.7}}
fixtures:
  - {name: sculpture, universe: 1, address: 1, channels: [intensity]}
  - {name: fountain, universe: 1, address: 510, channels: [red, green, blue], end: {blue: 0.5}}
  - {name: lawn, universe: 7, address: 1, channels: [warm, cold], end: 0.25}
relay_banks: [{name: street, device: {driver: simulated}}, {name: stage, device: {driver: modbus_tcp, host: 10.0.0.8}}]
relays: [{name: road-north, bank: street, coil: 4, safe: on}, {name: fog, bank: stage, coil: 4, safe: off},
         {name: road-south, bank: street, coil: 0, safe: on}]
cue_controller:
  device: {driver: simulated}
  buttons: {go: 1, blackout: 3, lists: {Bar: {go: 7, back: 8}}}
contact_banks: [{name: doors, device: {driver: simulated}}]
contacts:
  - {name: gate, input: 4, closes: go}
  - {name: emergency, input: 0, closes: dark, opens: light}
camera:
  device: {driver: simulated}
  size: [320, 180]
  field_of_view: 60
  position: [0, 2, 12]
  look_at: [0, 1, 0]
  k1: -0.05
simulation: {seed: 3}
end_fade: 2.5
)";

// What readSite says of the text, led by the file's name.
std::string siteRefusal(const std::string& text) {
    const ScratchFolder folder;
    const auto site = readSite(folder.file("site.yaml", text));
    return site ? "accepted" : folder.relative(site.error().message());
}
std::string siteRefusalAfter(std::string_view what, std::string_view by) {
    return siteRefusal(replaced(std::string(kSite), what, by));
}

TEST(Site, reads_a_measured_lens_and_light_and_has_usual_ones_without) {
    const ScratchFolder folder;
    const auto plain = readSite(folder.file("site.yaml", kSite));
    EXPECT_FALSE(plain->nominalCamera->centre);
    EXPECT_THAT(plain->nominalCamera->response, IsEmpty());
    const std::string more =
        "  k1: -0.05\n  centre: [321.5, 170]\n  lens_of: C525\n  response: [0, 0.2, 1]\n  hot_pixels: [[4, 5]]";
    const auto site = readSite(folder.file("site.yaml", replaced(std::string(kSite), "  k1: -0.05", more)));
    ASSERT_TRUE(site) << site.error().message();
    EXPECT_EQ(site->nominalCamera->centre, glm::dvec2(321.5, 170));
    EXPECT_EQ(site->nominalCamera->lensOf, "C525");
    EXPECT_THAT(site->nominalCamera->response, ElementsAre(0, 0.2, 1));
    EXPECT_THAT(site->nominalCamera->hotPixels, ElementsAre(glm::ivec2(4, 5)));
    EXPECT_THAT(siteRefusalAfter("  k1: -0.05", "  k1: -0.05\n  response: [0, 0.3, 0.2, 1]"),
                HasSubstr("response[2]: the light of a higher"));
    EXPECT_THAT(siteRefusalAfter("  k1: -0.05", "  k1: -0.05\n  response: [0.1, 1]"), HasSubstr("must rise from 0"));
}

TEST(Site, reads_everything_that_the_file_says) {
    const ScratchFolder folder;
    const auto site = readSite(folder.file("site.yaml", kSite));
    ASSERT_TRUE(site) << site.error().message();

    ASSERT_EQ(site->outputs.size(), 2u);
    const Output& left = site->outputs[0];
    EXPECT_EQ(left.name, "left");
    EXPECT_EQ(left.display.driver, "headless");
    EXPECT_EQ(left.size(), glm::ivec2(640, 360));
    EXPECT_EQ(left.refreshRate, 30);
    EXPECT_THAT(left.projection.warp.shape().corners,
                ElementsAre(glm::dvec2(10, 0), glm::dvec2(640, 20), glm::dvec2(630, 360), glm::dvec2(0, 350)));
    EXPECT_EQ(left.projector->pose.position, glm::dvec3(0, 4, 9));
    EXPECT_EQ(left.projector->throwRatio, 1.4);
    EXPECT_EQ(left.surface->normal, glm::dvec3(0, 0, 1));  // made a unit

    ASSERT_EQ(site->universes.size(), 2u);
    EXPECT_EQ(site->universes[1].number, 7);
    EXPECT_EQ(site->universes[1].port.driver, "artnet");
    EXPECT_FALSE(site->universes[1].desk);
    EXPECT_EQ(site->universes[0].desk->device.driver, "sacn");
    EXPECT_EQ(site->universes[0].desk->merge.rule, DmxMerge::Rule::Latest);
    EXPECT_EQ(site->universes[0].desk->merge.ownPriority, 90);
    EXPECT_EQ(site->universes[0].desk->merge.settling, std::chrono::seconds(2));
    EXPECT_THAT(site->fixtures[1].channels, ElementsAre("red", "green", "blue"));
    EXPECT_EQ(site->channelCount(), 6u);
    EXPECT_THAT(endLevels(*site), ElementsAre(0, 0, 0, 0.5, 0.25, 0.25)) << "dark where nothing else is said";
    EXPECT_EQ(site->endFade, std::chrono::milliseconds(2500));
    EXPECT_EQ(site->relayBanks[1].name, "stage");
    EXPECT_EQ(site->relayBanks[1].device.driver, "modbus_tcp");
    EXPECT_EQ(site->relays[0].bank, 0u);
    EXPECT_EQ(site->relays[0].coil, 4);
    EXPECT_TRUE(site->relays[0].safe);
    EXPECT_EQ(site->relays[1].bank, 1u);
    EXPECT_FALSE(site->relays[1].safe);
    EXPECT_EQ(site->coilCount(0), 5u);
    EXPECT_THAT(site->buttons, ElementsAre(SiteButton{1, Button::Go}, SiteButton{3, Button::Blackout},
                                           SiteButton{7, Button::Go, "Bar"}, SiteButton{8, Button::Back, "Bar"}));
    EXPECT_EQ(site->contacts[0].bank, 0u) << "there is one";
    EXPECT_EQ(site->contacts[0].closes, ContactAction::Go);
    EXPECT_EQ(site->contacts[0].opens, std::nullopt);
    EXPECT_EQ(site->contacts[1].opens, ContactAction::Light);
    EXPECT_EQ(site->inputCount(0), 5u);
    EXPECT_NEAR(site->nominalCamera->fieldOfView, std::numbers::pi / 3, 1e-12);
    EXPECT_EQ(site->nominalCamera->k1, -0.05);
    EXPECT_TRUE(site->simulation);
}

// The driver of a device reads its own keys, so the whole map must reach it.
TEST(Site, hands_the_drivers_keys_on_unread) {
    const ScratchFolder folder;
    const auto site = readSite(folder.file("site.yaml", kSite));
    const auto entries = site->outputs[0].display.options.entries();
    ASSERT_EQ(entries->size(), 2u);
    EXPECT_EQ((*entries)[1].first, "colour");
    EXPECT_EQ(*(*entries)[1].second.text(), "red");
}

// Corners are the only thing that a technician may leave out for a straight projector.
TEST(Site, without_corners_the_canvas_fills_the_picture) {
    const ScratchFolder folder;
    const auto site = readSite(folder.file("site.yaml", kSite));
    const Warp& straight = site->outputs[1].projection.warp;
    EXPECT_LT(glm::distance(straight.projectorFromCanvas({1, 1}), glm::dvec2(1920, 1080)), 1e-9);
    EXPECT_LT(glm::distance(straight.projectorFromCanvas({0.5, 0.5}), glm::dvec2(960, 540)), 1e-9);
    EXPECT_LT(glm::distance(site->outputs[0].projection.warp.projectorFromCanvas({1, 0}), glm::dvec2(640, 20)), 1e-9);
}

TEST(Site, a_site_of_projectors_alone_is_a_site) {
    EXPECT_EQ(siteRefusal("fantascope: site\nversion: 1\noutputs:\n  - {name: a, display: {driver: glfw}, size: [640, 360], "
                          "refresh_rate: 60}\n"),
              "accepted");
}

TEST(Site, says_which_lamps_may_be_trimmed) {
    const ScratchFolder folder;
    const auto with = [&](const std::string& lamps) {
        return readSite(folder.file("site.yaml", std::string(kSite) + "corrections: {lamps: {" + lamps + "}}\n"));
    };
    const auto none = readSite(folder.file("site.yaml", kSite));
    EXPECT_EQ(none->corrections.lamps.mode, Corrections::Mode::Advise);
    EXPECT_FALSE(none->corrections.lamps.any()) << "none unless the file names it";
    const auto site =
        with("mode: automatic, fixtures: [fountain, sculpture], relays: [road-south], least: 0.5, speed: 0.01, hold: 60");
    ASSERT_TRUE(site) << site.error().message();
    EXPECT_EQ(site->corrections.lamps.mode, Corrections::Mode::Automatic);
    EXPECT_THAT(site->corrections.lamps.fixtures, ElementsAre(1, 0));
    EXPECT_THAT(site->corrections.lamps.relays, ElementsAre(2));
    EXPECT_EQ(site->corrections.lamps.least, 0.5);
    EXPECT_EQ(site->corrections.lamps.speed, 0.01);
    EXPECT_EQ(site->corrections.lamps.hold, std::chrono::minutes(1));
    const auto refused = [&](const std::string& lamps) {
        const auto read = with(lamps);
        return read ? "accepted" : folder.relative(read.error().message());
    };
    EXPECT_EQ(refused("fixtures: [sculpture, tree]"),
              "site.yaml:38:45: corrections.lamps.fixtures[1]: there is no fixture 'tree'; there are sculpture, fountain, lawn");
    EXPECT_THAT(refused("relays: [sculpture]"), HasSubstr("corrections.lamps.relays[0]: there is no relay 'sculpture'"));
    EXPECT_THAT(refused("fixtures: [sculpture, sculpture]"), HasSubstr("fixture 'sculpture' is named twice"));
    EXPECT_THAT(refused("fixtures: [lawn]"), HasSubstr("neither a channel 'intensity' nor colours"));
    EXPECT_THAT(refused("speed: 0.06"), HasSubstr("0.001 .. 0.05"));
    EXPECT_THAT(refused("least: -0.1"), HasSubstr("0 .. 1"));
    EXPECT_THAT(refused("hold: 1"), HasSubstr("10 .. 86400"));
    EXPECT_THAT(refused("fixtures: [sculpture]}, geometry: {mode: off"), HasSubstr("needs the watch of the wall"));
    EXPECT_EQ(refused("mode: off, fixtures: [sculpture]}, geometry: {mode: off"), "accepted");
}

TEST(Site, mistakes_are_refused_with_place_and_advice) {
    EXPECT_EQ(siteRefusalAfter("    refresh_rate: 30\n", ""), "site.yaml:4:5: outputs[0]: 'refresh_rate' is missing");
    EXPECT_EQ(siteRefusalAfter("corners:", "cornres:"),
              "site.yaml:8:5: outputs[0].cornres: unknown key (did you mean 'corners'?)");
    EXPECT_EQ(siteRefusalAfter("size: [640, 360]", "size: wide"),
              "site.yaml:6:11: outputs[0].size: a list is needed, here is 'wide'");
    EXPECT_EQ(siteRefusalAfter("[1920, 1080]", "[1920, 0]"),
              "site.yaml:11:57: outputs[1].size[1]: 0 is out of range, 1 .. 16384 is allowed");
    EXPECT_EQ(siteRefusalAfter("field_of_view: 60", "field_of_view: 1.2 rad"),
              "site.yaml:32:18: camera.field_of_view: a number in 1 .. 179 degrees is needed, here is '1.2 rad'");
    EXPECT_EQ(siteRefusalAfter("display: {driver: glfw}", "display: {name: glfw}"),
              "site.yaml:11:28: outputs[1].display: 'driver' is missing: the name of the device's driver");
    EXPECT_EQ(siteRefusalAfter("safe: off", "safe: open"),
              "site.yaml:20:103: relays[1].safe: one of off, on is needed, here is 'open'");
    EXPECT_EQ(siteRefusalAfter("end: {blue: 0.5}", "end: {bleu: 0.5}"),
              "site.yaml:17:91: fixtures[1].end.bleu: 'fountain' has no channel 'bleu'; it has red, green, blue");
    EXPECT_EQ(siteRefusalAfter(", closes: go", ""),
              "site.yaml:27:5: contacts[0]: 'gate' asks for nothing; say what it does when it 'closes' or 'opens'");
    EXPECT_EQ(siteRefusalAfter("look_at: [0, 1, 0], throw", "look_at: [0, 4, 9], throw"),
              "site.yaml:9:16: outputs[0].projector: target and position are the same point; move one of them");
    EXPECT_EQ(siteRefusal("fantascope: site\nversion: 1\noutputs: []\n"),
              "site.yaml:3:10: outputs: a list of at least 1 items is needed, here are 0");
    EXPECT_THAT(readSite("nowhere/site.yaml").error().message(), EndsWith("cannot be read: No such file or directory"));
}

TEST(Site, names_that_recordings_could_not_be_called_by_are_refused) {
    EXPECT_EQ(siteRefusalAfter("name: right", "name: ../right"),
              "site.yaml:11:12: outputs[1].name: '../right' is no name: it may not contain a '/' or begin with a '.'");
}

// A show that names one of two things of one name would light the wrong one.
TEST(Site, what_must_differ_is_refused_when_it_is_the_same) {
    EXPECT_EQ(siteRefusalAfter("name: right", "name: left"),
              "site.yaml:11:12: outputs[1].name: left is taken by another output; each needs its own");
    EXPECT_EQ(siteRefusalAfter("number: 7", "number: 1"),
              "site.yaml:14:14: universes[1].number: 1 is taken by another universe; each needs its own");
    EXPECT_EQ(siteRefusalAfter("name: lawn", "name: fountain"),
              "site.yaml:18:12: fixtures[2].name: fountain is taken by another fixture; each needs its own");
    EXPECT_EQ(siteRefusalAfter("[warm, cold]", "[warm, warm]"),
              "site.yaml:18:60: fixtures[2].channels[1]: warm is taken by another channel of this fixture; each needs its own");
    EXPECT_EQ(siteRefusalAfter("name: fog", "name: road-north"),
              "site.yaml:20:70: relays[1].name: road-north is taken by another relay; each needs its own");
    EXPECT_EQ(siteRefusalAfter("coil: 0", "coil: 4"),
              "site.yaml:21:49: relays[2].coil: 4 is taken by another relay of its bank; each needs its own");
    EXPECT_EQ(siteRefusalAfter("blackout: 3", "blackout: 1"),
              "site.yaml:24:30: cue_controller.buttons.blackout: 1 is taken by another button; each needs its own");
    EXPECT_THAT(siteRefusalAfter("{go: 7, back: 8}", "{go: 7, back: 3}"),
                HasSubstr("cue_controller.buttons.lists.Bar.back: 3 is taken by another button"));
    EXPECT_THAT(siteRefusalAfter("{go: 7, back: 8}", "{back: 8}"), HasSubstr("buttons.lists.Bar: 'go' is missing"));
    EXPECT_EQ(siteRefusalAfter("input: 0", "input: 4"),
              "site.yaml:28:30: contacts[1].input: 4 is taken by another contact of its bank; each needs its own");
}

// Devices go by their names in messages, tests and fault scripts.
TEST(Site, no_bank_has_the_name_of_another_device) {
    for (const char* taken : {"street", "left", "universe 7", "desk 1", "cue controller", "camera"})
        EXPECT_EQ(
            siteRefusalAfter("name: doors", std::string("name: ") + taken),
            fmt::format("site.yaml:25:24: contact_banks[0].name: {} is taken by another device; each needs its own", taken));
}

TEST(Site, a_bank_is_named_where_there_are_several_and_holds_something) {
    EXPECT_EQ(siteRefusalAfter("name: fog, bank: stage", "name: fog"), "site.yaml:20:63: relays[1]: 'bank' is missing");
    EXPECT_EQ(siteRefusalAfter("bank: stage", "bank: stag"),
              "site.yaml:20:81: relays[1].bank: one of street, stage is needed, here is 'stag' (did you mean 'stage'?)");
    EXPECT_EQ(siteRefusalAfter("bank: stage", "bank: street"),
              "site.yaml:20:95: relays[1].coil: 4 is taken by another relay of its bank; each needs its own");
    EXPECT_EQ(siteRefusalAfter("fog, bank: stage, coil: 4", "fog, bank: street, coil: 1"),
              "site.yaml:19:60: relay_banks[1]: the bank 'stage' is empty; add to it under 'relays', or remove it");
    EXPECT_EQ(siteRefusalAfter("contact_banks: [{name: doors, device: {driver: simulated}}]\n", ""),
              "site.yaml:26:25: contacts[0].input: there is no bank; add it under 'contact_banks'");
}

// What files said as long as there could be one of each.
TEST(Site, the_old_keys_of_a_bank_are_refused_with_what_to_write_now) {
    EXPECT_EQ(siteRefusalAfter("contact_banks: [{name: doors, device: {driver: simulated}}]\ncontacts:",
                               "contact_bank:\n  device: {driver: simulated}\n  contacts:"),
              "site.yaml:26:3: contact_bank: there may be several now; write 'contact_banks: [{name: NAME, device: ...}]', and "
              "'contacts' beside it instead of in it");
    EXPECT_EQ(siteRefusalAfter("relay_banks: [", "relay_bank: ["),
              "site.yaml:19:13: relay_bank: there may be several now; write 'relay_banks: [{name: NAME, device: ...}]', and "
              "'relays' beside it instead of in it");
}

TEST(Site, fixtures_stay_in_their_universe_and_off_each_other) {
    EXPECT_EQ(siteRefusalAfter("address: 1, channels: [intensity]", "address: 511, channels: [intensity]"),
              "site.yaml:17:5: fixtures[1]: 'sculpture' and 'fountain' overlap at slot 511 of universe 1; move one of them");
    EXPECT_EQ(siteRefusalAfter("address: 510", "address: 511"),
              "site.yaml:17:5: fixtures[1]: 'fountain' would reach slot 513, a universe ends at 512; move its address");
    EXPECT_EQ(siteRefusalAfter("universe: 7, address", "universe: 8, address"),
              "site.yaml:18:28: fixtures[2].universe: universe 8 is not declared; add it under 'universes'");
}

TEST(Site, corners_that_make_no_picture_are_refused) {
    EXPECT_EQ(
        siteRefusalAfter("[[10, 0], [640, 20], [630, 360], [0, 350]]", "[[10, 0], [640, 20], [0, 350], [630, 360]]"),
        "site.yaml:8:14: outputs[0].corners: the corners are crossed or folded inwards; go round from the top left: top-right, "
        "bottom-right, bottom-left");
    EXPECT_EQ(siteRefusalAfter("[[10, 0], [640, 20], [630, 360], [0, 350]]", "[[10, 0], [640, 20], [630, 360]]"),
              "site.yaml:8:14: outputs[0].corners: a list of exactly 4 items is needed, here are 3");
}

TEST(Site, reads_how_a_projector_throws_its_part_of_a_canvas) {
    const ScratchFolder folder;
    writePng(folder.path() / "trees.png", GreyImage(4, 2, 1.0f)).value();
    folder.file("warm.cube", "LUT_3D_SIZE 2\n" + std::string("0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n"));
    const std::string text = replaced(std::string(kSite), "refresh_rate: 59.94}",
                                      R"(refresh_rate: 59.94, canvas: wall, part: [0.4, 0, 1, 0.9], flip: horizontal, turn: 270,
     mesh: {points: [2, 2], between: straight, offsets: [[0, 0], [1, 2], [0, 0], [3, 4]]},
     masks: [{polygon: [[0, 0], [9, 0], [0, 9]], hides: outside, feather: 5}, {image: trees.png}],
     light: {gamma: 2.4, black_level: 0.001, white: [1, 0.9, 0.8], brightness: 0.7, lut: warm.cube, dither: false}})");
    const auto site = readSite(folder.file("site.yaml", text));
    ASSERT_TRUE(site) << site.error().message();
    EXPECT_EQ(site->outputs[0].canvas, "left") << "alone on a canvas of its own";
    EXPECT_THAT(site->outputsOn("wall"), ElementsAre(1u));
    const Projection& projection = site->outputs[1].projection;
    const WarpShape& warp = projection.warp.shape();
    EXPECT_EQ(warp.part, (CanvasPart{{0.4, 0}, {1, 0.9}}));
    EXPECT_EQ(warp.orientation, (Orientation{Orientation::Flip::Horizontal, 3}));
    EXPECT_EQ(warp.mesh, (WarpMesh{WarpMesh::Between::Straight, {2, 2}, {{0, 0}, {1, 2}, {0, 0}, {3, 4}}}));
    ASSERT_EQ(projection.masks.size(), 2u);
    EXPECT_TRUE(projection.masks[0].hidesOutside);
    EXPECT_EQ(projection.masks[0].feather, 5);
    EXPECT_EQ(projection.masks[1].image->width(), 4);
    EXPECT_EQ(projection.light.gamma, 2.4);
    EXPECT_EQ(projection.light.white, glm::dvec3(1, 0.9, 0.8));
    EXPECT_EQ(projection.light.cube->side, 2);
    EXPECT_FALSE(projection.light.dither);
    EXPECT_EQ(site->outputs[0].projection.light.gamma, std::nullopt) << "a monitor";
}

TEST(Site, what_cannot_be_projected_is_refused_with_place_and_advice) {
    const auto refusalOf = [](const std::string& keys) {
        return siteRefusalAfter("refresh_rate: 59.94}", "refresh_rate: 59.94, " + keys + "}");
    };
    EXPECT_THAT(refusalOf("corners: [[2000, 0], [2100, 0], [2100, 9], [2000, 9]]"),
                EndsWith("nothing of the picture would be seen: its corners lie outside of the 1920 x 1080 pixels"));
    EXPECT_THAT(refusalOf("part: [0.5, 0, 0.5, 1]"),
                EndsWith("left comes before right and top before bottom: [left, top, right, bottom]"));
    EXPECT_THAT(refusalOf("turn: 45"), EndsWith("outputs[1].turn: one of 0, 90, 180, 270 is needed, here is '45'"));
    EXPECT_THAT(refusalOf("mesh: {points: [2, 2], offsets: [[0, 0]]}"),
                EndsWith("outputs[1]: a mesh of 2 x 2 points has 4 offsets, here are 1"));
    EXPECT_THAT(refusalOf("mesh: {points: [2, 2], offsets: [[3000, 0], [0, 0], [0, 0], [0, 0]]}"),
                HasSubstr("folds the picture"));
    EXPECT_THAT(refusalOf("masks: [{feather: 3}]"), EndsWith("a mask is either a 'polygon' or an 'image'"));
    EXPECT_THAT(refusalOf("masks: [{image: nowhere.png}]"), HasSubstr("nowhere.png"));
    EXPECT_THAT(refusalOf("light: {gamma: bright}"), EndsWith("here is 'bright'; or 'srgb'"));
    EXPECT_THAT(refusalOf("light: {lut: nowhere.cube}"),
                AllOf(StartsWith("site.yaml:11:"), HasSubstr("nowhere.cube: cannot be read")));
    EXPECT_THAT(refusalOf("canvas: left"), EndsWith("'left' is the name of an output; give the canvas another"));
}

TEST(Site, a_surface_faces_its_projector) {
    EXPECT_EQ(
        siteRefusalAfter("normal: [0, 0, 0.5]", "normal: [0, 0, -1]"),
        "site.yaml:4:5: outputs[0]: the projector stands behind its surface; turn the surface's normal towards the projector");
    EXPECT_EQ(siteRefusalAfter("normal: [0, 0, 0.5]", "normal: [0, 0, 0]"),
              "site.yaml:10:14: outputs[0].surface: the normal has no length; give the direction that the surface faces");
}

// A projector that hangs from a mast and looks straight down has no top of its own.
TEST(Site, looking_straight_down_needs_up) {
    const std::string_view aim = "position: [0, 4, 9], look_at: [0, 1, 0]";
    const std::string_view surface = "normal: [0, 0, 0.5]";
    const std::string flat = replaced(std::string(kSite), surface, "normal: [0, 1, 0]");
    EXPECT_EQ(siteRefusal(replaced(flat, aim, "position: [0, 4, 0], look_at: [0, 0, 0]")),
              "site.yaml:9:16: outputs[0].projector: 'up' is zero or along the view; give another 'up'");
    EXPECT_EQ(siteRefusal(replaced(flat, aim, "position: [0, 4, 0], look_at: [0, 0, 0], up: [0, 0, -1]")), "accepted");
    EXPECT_EQ(siteRefusal(replaced(flat, aim, "position: [0, 4, 0], look_at: [0, 0, 0], up: [0, 0, 0]")),
              "site.yaml:9:16: outputs[0].projector: 'up' is zero or along the view; give another 'up'");
}

}  // namespace
}  // namespace fantascope::show
