// The light correction on a simulated wall with stains.

#include "drawing_on_a_wall.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <string>

namespace fantascope::app {
namespace {

using testing::HasSubstr;

class LightOnAStainedWall : public DrawingOnAWall {
protected:
    LightOnAStainedWall() : DrawingOnAWall({{640, 360}, 30, 10, "{light: {mode: off, least: 0.1}}", 400}) {
        paint([](int x, int y) { return 0.38 + 0.28 * std::sin(x / 23.0) * std::cos(y / 19.0); });
        calibrate();
    }
    Played show() const { return play("6.5"); }
    // Once the correction is faded in.
    static double zOf(const Played& played) { return played.mean("z_camera", 5.2, 6.5, 5); }
    static double toneOf(const Played& played) { return played.mean("tone_camera", 5.2, 6.5, 5); }
};

TEST_F(LightOnAStainedWall, is_nearer_to_the_drawing_if_it_is_evened_out_and_nearest_if_the_pattern_knows_the_wall) {
    search();
    const Played off = show();
    EXPECT_TRUE(off.report["light_correction"].empty());
    setMode("light", "advise");
    const Played advised = show();
    EXPECT_EQ(advised.film, off.film) << "advice changes no byte";
    EXPECT_THAT(advised.told, HasSubstr("the light of 'left' could be evened out"));
    EXPECT_EQ(advised.report["light_correction"]["left"]["applied"], false);

    setMode("light", "automatic");
    const Played evened = show();
    EXPECT_THAT(evened.told, HasSubstr("the light of 'left' is evened out"));
    EXPECT_EQ(evened.report["light_correction"]["left"]["applied"], true);
    EXPECT_LT(evened.report["light_correction"]["left"]["kept"], 0.9);
    EXPECT_LT(toneOf(evened), 0.7 * toneOf(off));
    EXPECT_LT(zOf(evened), 0.7 * zOf(off));

    search({"--surface", "site.yaml:left"});
    const Played both = show();
    EXPECT_LT(toneOf(both), toneOf(evened));
    setMode("light", "off");
    search({"--surface", "site.yaml:left"});
    EXPECT_LT(toneOf(show()), 0.7 * toneOf(off));
    const auto report = nlohmann::json::parse(contentsOf(folder_ / "pattern.json"));
    EXPECT_LT(report["tone_surface"], report["tone"]) << "on plain white it is the pattern of a stained wall";
}

TEST_F(LightOnAStainedWall, is_left_alone_and_told_if_the_picture_was_moved_by_hand) {
    search();
    setMode("light", "automatic");
    std::string text = contentsOf(folder_ / "site.yaml");
    text.replace(text.find("corners: [["), 11, "corners: [[1");  // ten pixels and more to the right
    folder_.file("site.yaml", text);
    const Played moved = show();
    EXPECT_THAT(moved.told, HasSubstr("the light of 'left' is not evened out: output 'left': its picture was moved since"));
    EXPECT_EQ(moved.report["light_correction"]["left"]["applied"], false);
    EXPECT_THAT(run({"pattern", "guide.png", "-o", "x.pattern.yaml", "--iterations", "1", "--surface", "site.yaml:left"}),
                exits(1));
}

}  // namespace
}  // namespace fantascope::app
