// A pattern that is fitted to a stained wall while its show runs.

#include "drawing_on_a_wall.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace fantascope::app {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class PatternOnItsWall : public DrawingOnAWall {
protected:
    PatternOnItsWall() : DrawingOnAWall({{320, 180}, 5, 2.5, "{light: {mode: off}, pattern: {mode: off, fade: 2}}", 300}) {
        stain(1);
        calibrate();
        search();
    }
    // Gravel, on which a stain gives back a share of the light.
    void stain(double share) const {
        paint([&](int x, int y) {
            const bool isStained = std::hypot((x - 210) / 50.0, (y - 120) / 40.0) < 1;
            return (0.5 + 0.1 * std::sin(x * 0.9) * std::sin(y * 1.1)) * (isStained ? share : 1);
        });
    }
    Played show() const { return play("56"); }
};

// The stain came after the calibration.
TEST_F(PatternOnItsWall, reads_better_on_a_stain_that_the_camera_finds_during_the_show) {
    stain(0.45);
    const Played off = show();
    EXPECT_THAT(off.report["patterns"], IsEmpty());
    setMode("pattern", "advise");
    const Played advised = show();
    EXPECT_EQ(advised.film, off.film) << "advice changes no byte";
    EXPECT_THAT(advised.told, HasSubstr("better on this wall (corrections: pattern: {mode: automatic})"));
    setMode("pattern", "automatic");
    const Played fitted = show();
    EXPECT_THAT(fitted.told, HasSubstr("drawing: the pattern is fitted to this wall"));
    ASSERT_THAT(fitted.report["patterns"], SizeIs(1));
    const auto& exchange = fitted.report["patterns"][0];
    EXPECT_EQ(exchange["applied"], true);
    EXPECT_LT(exchange["tone_after"], 0.8 * exchange["tone_before"].get<double>());
    EXPECT_LT(exchange["at"], 50);
    EXPECT_EQ(fitted.mean("tone_camera", 2, 35), off.mean("tone_camera", 2, 35));
    EXPECT_LT(fitted.mean("tone_camera", 48, 56), 0.88 * off.mean("tone_camera", 48, 56));
    EXPECT_LT(fitted.mean("z_camera", 48, 56), off.mean("z_camera", 48, 56));
    for (const auto& cause : fitted.report["causes"]) EXPECT_LT(cause["from"], 40) << cause << ": the exchange names no cause";
    EXPECT_EQ(show().film, fitted.film) << "the same show, whatever time the search takes";
}

TEST_F(PatternOnItsWall, stays_as_it_is_on_the_wall_that_was_calibrated) {
    setMode("pattern", "automatic");
    EXPECT_THAT(show().report["patterns"], IsEmpty());
}

}  // namespace
}  // namespace fantascope::app
