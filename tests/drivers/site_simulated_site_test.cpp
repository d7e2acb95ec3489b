#include "drivers/simulated_stage.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <thread>

namespace fantascope::site {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

TEST(SimulatedSite, exposes_at_its_frame_rate_and_delivers_after_its_latency) {
    Stage stage;
    stage.advanceTo(0ms);
    EXPECT_EQ(stage.site_->nextEvent(), Time(100ms));
    stage.advanceTo(49ms);
    EXPECT_EQ(stage.world_.takeFromCamera(), nullptr) << "still on its way";
    stage.advanceTo(50ms);
    const auto first = stage.world_.takeFromCamera();
    ASSERT_NE(first, nullptr);
    EXPECT_EQ(first->exposed, Time(0ms));
    EXPECT_EQ(first->sequence, 0u);
    EXPECT_EQ(first->image.width(), 48);
    stage.advanceTo(149ms);
    EXPECT_EQ(stage.world_.takeFromCamera(), nullptr);
    stage.advanceTo(150ms);
    EXPECT_EQ(stage.world_.takeFromCamera()->exposed, Time(100ms));
}

// With coarse steps, or on a slow machine, only the newest frame is exposed; a backlog would grow.
TEST(SimulatedSite, drops_frames_that_nobody_can_see_any_more) {
    Stage stage;
    stage.advanceTo(0ms);
    stage.advanceTo(1040ms);
    stage.clock_.advanceTo(1100ms);
    const auto frame = stage.world_.takeFromCamera();
    EXPECT_EQ(frame->exposed, Time(1000ms));
    EXPECT_EQ(frame->sequence, 10u) << "the gap tells of the others";
}

TEST(SimulatedSite, counts_from_its_beginning) {
    Stage stage("faults: [{kind: unplug, device: left, at: 0.5}]");
    stage.site_->begin(10s);
    stage.advanceTo(9s);
    EXPECT_EQ(stage.site_->nextEvent(), Time(10s));
    EXPECT_EQ(stage.world_.takeFromCamera(), nullptr);
    stage.advanceTo(10400ms);
    EXPECT_TRUE(stage.world_.plugged("left"));
    stage.advanceTo(10500ms);
    EXPECT_FALSE(stage.world_.plugged("left"));
    EXPECT_THAT(told(*stage.site_), ElementsAre("0.5 left unplugged"));
}

TEST(SimulatedSite, sees_what_projectors_lamps_and_relays_do) {
    Stage stage;
    const auto dark = stage.lookAtPictures();
    stage.show("left", 255);
    auto seen = stage.lookAtPictures();
    EXPECT_GT(seen[0].g, dark[0].g + 50);
    EXPECT_EQ(seen[1], dark[1]) << "the other picture";
    EXPECT_EQ(seen[2], dark[2]) << "between the pictures";
    stage.show("left", 0);
    EXPECT_GT(stage.lookAtPictures()[0].g, dark[0].g) << "black leaks";

    // Lamps are linear in their level.
    stage.world_.setFrame("left", nullptr);
    stage.setSlot(10, 255);
    const double full = linear(stage.lookAtPictures()[2].g) - linear(dark[2].g);
    stage.setSlot(10, 51);
    EXPECT_NEAR(linear(stage.lookAtPictures()[2].g) - linear(dark[2].g), full / 5, 0.02 * full);
    stage.setSlot(10, 0);
    stage.setSlot(11, 255);
    EXPECT_EQ(stage.lookAtPictures(), dark) << "pan gives no light";
    stage.setSlot(13, 255);
    seen = stage.lookAtPictures();
    EXPECT_GT(seen[2].g, dark[2].g + 20) << "the wash's green";
    EXPECT_EQ(seen[2].r, dark[2].r);

    stage.setSlot(13, 0);
    stage.world_.setRelays("road", {false, true});
    seen = stage.lookAtPictures();
    EXPECT_GT(seen[2].r, seen[2].g + 10) << "the street lamp is orange";
    EXPECT_EQ(seen[2].b, dark[2].b);
    stage.world_.setRelays("road", {true, false});
    EXPECT_EQ(stage.lookAtPictures(), dark);
}

TEST(SimulatedSite, gives_the_same_bytes_for_the_same_seed) {
    const std::string faults =
        "faults: [{kind: bump, output: left, at: 0.3, turn: [0, 2, 0]}, {kind: fog, at: 0.1, density: 0.05, rise: 1}]";
    const auto night = [&](std::uint64_t seed) {
        Stage stage(faults, "white: 40, read_noise: 0.01, shot_noise: 0.02", seed);
        std::vector<RgbaImage> frames;
        for (int i = 0; i < 6; ++i) {
            stage.show("left", static_cast<std::uint8_t>(40 * i));
            stage.setSlot(10, static_cast<std::uint8_t>(20 * i));
            frames.push_back(stage.look()->image);
        }
        return frames;
    };
    const auto first = night(1);
    EXPECT_EQ(first, night(1));
    EXPECT_NE(first, night(2));
}

// The loop from the header, on a clock that its sleep moves; devices and console work in parallel.
TEST(SimulatedSite, runs_on_a_thread_of_its_own) {
    Stage stage(
        "faults: [{kind: bump, output: left, at: 0.5, until: 1, turn: [0, 1, 0]}, {kind: unplug, device: right, at: 1.5}]");
    std::atomic<bool> stopped = false;
    std::jthread thread([&] {
        while (!stopped) {
            stage.site_->advanceTo(stage.clock_.now());
            stage.clock_.sleepUntil(std::min(stage.site_->nextEvent(), stage.clock_.now() + 100ms));
        }
    });
    std::uint8_t value = 0;
    std::uint64_t last = 0;
    while (stage.site_->happenings().size() < 3) {
        stage.show("left", ++value);
        stage.setSlot(10, value);
        if (const auto frame = stage.world_.takeFromCamera()) {
            EXPECT_GE(frame->sequence, last);
            last = frame->sequence;
        }
    }
    stopped = true;
    thread.join();
    EXPECT_THAT(told(*stage.site_), ElementsAre("0.5 projector left bumped by 0.000 m and 1.00 degrees",
                                                "1.0 projector left put back", "1.5 right unplugged"));
    EXPECT_FALSE(stage.world_.plugged("right"));
}

// Example failure: an unplugged projector goes on glowing with its black level.
TEST(SimulatedSite, unplugs_a_device_and_plugs_it_in_again) {
    Stage stage("faults: [{kind: unplug, device: left, at: 1, until: 2}, {kind: unplug, device: camera, at: 3}]");
    const auto dark = stage.lookAtPictures();
    stage.show("left", 200);
    EXPECT_GT(stage.lookAtPictures()[0].g, dark[0].g);
    stage.advanceTo(1s);
    stage.show("left", 200);
    EXPECT_EQ(stage.lookAtPictures(), dark);
    stage.advanceTo(2s);
    stage.show("left", 200);
    EXPECT_GT(stage.lookAtPictures()[0].g, dark[0].g);
    stage.advanceTo(3s);
    EXPECT_EQ(stage.look(), nullptr);
    EXPECT_THAT(told(*stage.site_), ElementsAre("1.0 left unplugged", "2.0 left plugged in again", "3.0 camera unplugged"));
}

// Example failure: a fault at 0 comes only when the show begins, after the renderers were made.
TEST(SimulatedSite, has_the_graphics_of_an_output_fail) {
    Stage stage("faults: [{kind: graphics, device: left, at: 0, until: 1}, {kind: graphics, device: right, at: 2}]");
    EXPECT_FALSE(stage.world_.graphicsWork("left"));
    EXPECT_TRUE(stage.world_.graphicsWork("right"));
    stage.advanceTo(1s);
    EXPECT_TRUE(stage.world_.graphicsWork("left"));
    stage.advanceTo(2s);
    EXPECT_FALSE(stage.world_.graphicsWork("right"));
    EXPECT_THAT(told(*stage.site_),
                ElementsAre("0.0 graphics of left fail", "1.0 graphics of left work again", "2.0 graphics of right fail"));
}

TEST(SimulatedSite, freezes_a_projector_or_the_camera) {
    Stage stage("faults: [{kind: freeze, device: left, at: 1, until: 2}, {kind: freeze, device: camera, at: 3, until: 4}]");
    stage.show("left", 255);
    const auto bright = stage.lookAtPictures();
    stage.advanceTo(1s);
    stage.show("left", 0);
    EXPECT_EQ(stage.lookAtPictures(), bright) << "the projector keeps its picture";
    stage.advanceTo(2s);
    EXPECT_LT(stage.lookAtPictures()[0].g, bright[0].g);

    stage.show("left", 255);
    (void)stage.look();
    stage.advanceTo(3s);
    const auto before = stage.look();
    stage.show("left", 0);
    const auto after = stage.look();
    EXPECT_EQ(after->image, before->image) << "the camera repeats itself";
    EXPECT_GT(after->sequence, before->sequence) << "and does not know it";
    stage.advanceTo(4s);
    EXPECT_NE(stage.look()->image, before->image);
    EXPECT_THAT(told(*stage.site_),
                ElementsAre("1.0 left froze", "2.0 left moves again", "3.0 camera froze", "4.0 camera moves again"));
}

// The middle of the lit pixels' columns in the left half of a frame.
double middleOfLeft(const RgbaImage& image) {
    double sum = 0, weight = 0;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width() / 2; ++x) {
            const double light = std::max(0.0, linear(image.at(x, y).g) - 0.05);
            sum += light * (x + 0.5);
            weight += light;
        }
    return sum / weight;
}

TEST(SimulatedSite, bumps_a_projector_and_puts_it_back_exactly) {
    Stage stage(R"(faults:
  - {kind: bump, output: left, at: 1, until: 3, move: [0.2, 0, 0]}
  - {kind: bump, output: left, at: 2, until: 4, turn: [0, -4, 0]}
)");
    stage.show("left", 255);
    stage.show("right", 255);
    const auto right = [](const RgbaImage& image) { return image.at(34, 12); };
    const RgbaImage before = stage.look()->image;
    const double metre = nominalSite().camera->focal / 4;  // pixels
    stage.advanceTo(1s);
    const RgbaImage moved = stage.look()->image;
    EXPECT_NEAR(middleOfLeft(moved) - middleOfLeft(before), 0.2 * metre, 0.2) << "to the right, its own x axis";
    EXPECT_EQ(right(moved), right(before)) << "the other projector stays";
    stage.advanceTo(2s);
    const double turned = middleOfLeft(stage.look()->image) - middleOfLeft(before);
    EXPECT_NEAR(turned, (0.2 - 3 * std::tan(4 * 3.14159265 / 180)) * metre, 0.5) << "both at once; turned to the left about down";
    stage.advanceTo(3s);
    EXPECT_LT(middleOfLeft(stage.look()->image), middleOfLeft(before)) << "the turn alone";
    stage.advanceTo(4s);
    EXPECT_EQ(stage.look()->image, before);
    EXPECT_THAT(told(*stage.site_), ElementsAre("1.0 projector left bumped by 0.200 m and 0.00 degrees",
                                                "2.0 projector left bumped by 0.000 m and 4.00 degrees",
                                                "3.0 projector left put back", "4.0 projector left put back"));
}

// The fog builds up from 1 s to 3 s and clears from 5 s to 7 s. Meanwhile the pictures are fainter,
// and the dark wall between them is brighter.
TEST(SimulatedSite, lets_fog_come_and_go) {
    Stage stage("faults: [{kind: fog, at: 1, until: 5, density: 0.2, rise: 2}]");
    stage.show("left", 255);
    stage.show("right", 255);
    std::vector<double> picture, between;
    for (const Time time : {Time(500ms), Time(2s), Time(3s), Time(4s), Time(6s), Time(7s)}) {
        stage.advanceTo(time - 100ms);
        const auto seen = stage.lookAtPictures();  // exposed at `time`
        picture.push_back(linear(seen[0].g));
        between.push_back(linear(seen[2].g));
    }
    EXPECT_LT(picture[1], 0.9 * picture[0]);
    EXPECT_LT(picture[2], 0.9 * picture[1]);
    EXPECT_GT(between[2], between[0]);
    EXPECT_EQ(picture[3], picture[2]);
    EXPECT_EQ(picture[4], picture[1]) << "half way out as half way in";
    EXPECT_EQ(picture[5], picture[0]);
    EXPECT_EQ(between[5], between[0]);
    EXPECT_THAT(told(*stage.site_), ElementsAre("1.0 fog of 0.2 / m comes within 2 s", "5.0 fog clears within 2 s"));
}

// Two people in the gate: it opens when the last one goes.
TEST(SimulatedSite, closes_the_contacts_of_each_bank_for_as_long_as_it_is_told) {
    Stage stage(R"(contacts:
  - {contact: gate, at: 1, until: 3}
  - {contact: gate, at: 2, until: 4}
  - {contact: emergency, at: 2.5}
)");
    std::string seen;
    for (const Time time : {999ms, 1000ms, 2500ms, 3500ms, 4000ms}) {
        stage.advanceTo(time);
        seen += fmt::format(" {:d}{:d}", stage.world_.contact("doors", 3), stage.world_.contact("desk", 3));
    }
    EXPECT_EQ(seen, " 00 10 11 11 01");
    EXPECT_THAT(told(*stage.site_), IsEmpty()) << "it is no fault";
}

// Example failure: a gate closes with the next picture of the camera.
TEST(SimulatedSite, the_next_movement_of_a_contact_is_an_event) {
    Stage stage("contacts: [{contact: gate, at: 0.04, until: 0.07}]\n");
    stage.advanceTo(0ms);
    EXPECT_EQ(stage.site_->nextEvent(), Time(40ms));
    stage.advanceTo(40ms);
    EXPECT_EQ(stage.site_->nextEvent(), Time(70ms));
    stage.advanceTo(70ms);
    EXPECT_EQ(stage.site_->nextEvent(), Time(100ms));
}

TEST(SimulatedSite, refuses_a_malformed_section_with_place_and_advice) {
    const auto with = [](const std::string& more) { return refusal(simulationText(more)); };
    EXPECT_EQ(with(""), "accepted");
    EXPECT_EQ(with("fogg: 3"),
              "config/site.yaml:13:1: fogg: unknown key (known here: ambient, sky, objects, projectors, lamps, "
              "street_lamps, camera, walkers, headlights, contacts, faults)");
    EXPECT_EQ(refusal(simulationText("", "whit: 40")),
              "config/site.yaml:12:10: camera.whit: unknown key (did you mean 'white'?)");
    EXPECT_THAT(refusal(simulationText("", "white: 0")), StartsWith("config/site.yaml:12:17: camera.white: 0 is out of range"));

    const auto object = [](const std::string& shape) { return refusal("objects: [{name: x, " + shape + "}]\n"); };
    EXPECT_THAT(object("reflectance: [1, 1, 1]"), HasSubstr("objects[0]: exactly one of rectangle, box and mesh is needed"));
    EXPECT_THAT(object("box: {centre: [0, 0, 0], size: [1, 0, 1]}"), HasSubstr("objects[0].box.size[1]: 0 is out of range"));
    EXPECT_THAT(object("rectangle: {corner: [0, 0, 0], right: [1, 0, 0], up: [2, 0, 0]}"), HasSubstr("must span a rectangle"));
    EXPECT_THAT(object("mesh: {file: none.obj}"), AllOf(HasSubstr("config/site.yaml:1:"), HasSubstr("none.obj")));
    EXPECT_THAT(object("mesh: {file: /etc/passwd}"), HasSubstr("absolute"));
    EXPECT_THAT(refusal("ambient: [1, 1, 1]\n"), HasSubstr("'objects' is missing"));

    const auto lamps = [](const std::string& lamp) {
        return refusal("objects: [{name: x, box: {centre: [0, 0, 0], size: [1, 1, 1]}}]\nlamps: {" + lamp + "}\n");
    };
    EXPECT_THAT(lamps("spott: {}"), HasSubstr("lamps.spott: this site has no fixture 'spott' (did you mean 'spot'?)"));
    const std::string place = "position: [0, 0, 1], look_at: [0, 0, 0], candela: 1";
    EXPECT_THAT(lamps("spot: {" + place + ", beam_angle: 30, field_angle: 20}"),
                HasSubstr("lamps.spot: field_angle must be larger than beam_angle"));
    EXPECT_THAT(lamps("spot: {position: [0, 0, 1], look_at: [0, 0, 1], candela: 1, beam_angle: 10, field_angle: 20}"),
                HasSubstr("look_at must differ from position"));

    const auto closing = [&](const std::string& keys) { return with("contacts: [{" + keys + "}]"); };
    EXPECT_THAT(closing("contact: gat, at: 1"), HasSubstr("one of gate, emergency is needed, here is 'gat'"));
    EXPECT_THAT(closing("contact: gate, at: 2, until: 2"), HasSubstr("'until' must be later than 'at'"));

    const auto fault = [&](const std::string& keys) { return with("faults: [{" + keys + "}]"); };
    EXPECT_THAT(fault("at: 1, device: left"), HasSubstr("faults[0]: 'kind' is missing"));
    EXPECT_THAT(fault("device: left, kind: unplugg, at: 1"),
                AllOf(HasSubstr("13:31: faults[0].kind: one of unplug, freeze, graphics, bump, fog, "),
                      HasSubstr("is needed, here is 'unplugg' (did you mean 'unplug'?)")));
    EXPECT_THAT(fault("kind: unplug, device: universe 4, at: 1"), HasSubstr("did you mean 'universe 3'?"));
    EXPECT_THAT(fault("kind: freeze, device: road, at: 1"), HasSubstr("one of left, right, camera is needed"));
    EXPECT_THAT(fault("kind: bump, output: left, at: 1, density: 0.1"), HasSubstr("density: unknown key"));
    EXPECT_THAT(fault("kind: bump, output: middle, at: 1"), HasSubstr("one of left, right is needed"));
    EXPECT_THAT(fault("kind: fog, at: 2, until: 1, density: 0.1"), HasSubstr("'until' must be later than 'at'"));
    EXPECT_THAT(fault("kind: fog, at: -1, density: 0.1"), HasSubstr("out of range"));
}

}  // namespace
}  // namespace fantascope::site
