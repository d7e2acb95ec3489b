#include "theatre/deform/handle_motion.h"

#include "core/file.h"
#include "pictures.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <vector>

namespace fantascope::theatre {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// A white box of 100 x 200 pixels in a picture of 400 x 300, from (250, 60).
TriangulatedSilhouette aBox() {
    return TriangulatedSilhouette::of(pictureOf(400, 300, [](int x, int y) { return isIn(x, y, 250, 60, 100, 200); }), 60)
        .value();
}

class MotionFile : public testing::Test {
protected:
    Result<HandleMotion> read(const std::string& handles, const std::string& head = "seconds: 2\n") {
        folder_.file("a.motion.yaml", "fantascope: motion\nversion: 1\n" + head + "handles:\n" + handles);
        return readMotion(folder_ / "a.motion.yaml", box_);
    }
    std::string refusal(const std::string& handles, const std::string& head = "seconds: 2\n") {
        const auto found = read(handles, head);
        return found ? "read" : folder_.relative(found.error().message());
    }
    const TriangulatedSilhouette box_ = aBox();
    const ScratchFolder folder_;
};

TEST_F(MotionFile, gives_places_in_pixels_at_the_keys_times) {
    const auto motion = read(
        "  - {name: pin, at: [0.75, 0.8]}\n"
        "  - name: ear\n"
        "    at: [0.7, 0.3]\n"
        "    keys: [{time: 0.5, by: [0.1, -0.1]}, {time: 1, to: [0.5, 0.5]}, {time: 1.5, by: [0, 0]}]\n",
        "seconds: 2\nframes_per_second: 25\n");
    ASSERT_TRUE(motion) << motion.error().message();
    EXPECT_EQ(motion->seconds, 2);
    EXPECT_EQ(motion->framesPerSecond, 25);
    EXPECT_FALSE(motion->loops);
    const auto at = [&](std::size_t handle, double time) { return motion->placesAt(time)[handle]; };
    for (const double time : {0.0, 0.7, 2.0}) EXPECT_LT(glm::distance(at(0, time), {300, 240}), 1e-9) << "a pin";
    EXPECT_LT(glm::distance(at(1, 0.5), {320, 60}), 1e-9);
    EXPECT_LT(glm::distance(at(1, 1), {200, 150}), 1e-9);
    EXPECT_LT(glm::distance(at(1, 1.5), {280, 90}), 1e-9);
    // Held before the first and after the last.
    EXPECT_LT(glm::distance(at(1, 0), {320, 60}), 1e-9);
    EXPECT_LT(glm::distance(at(1, 2), {280, 90}), 1e-9);
    // Where the handle rests is a point of its triangles.
    EXPECT_LT(glm::distance(box_.placeOf(motion->handles[1].point, box_.rest.vertices), {280, 90}), 1e-9);
}

// Example failure: a cubic through the keys (Catmull & Rom) swings out before and after a jump.
TEST_F(MotionFile, is_eased_without_overshooting_and_without_a_jolt) {
    const auto motion = read(
        "  - {name: a, at: [0.7, 0.3], keys: [{time: 0, by: [0, 0]}, {time: 0.4, by: [0, 0.01]}, {time: 0.6, by: [0, 0.3]}, "
        "{time: 1.2, by: [0, 0.3]}, {time: 1.4, by: [0, 0.35]}, {time: 2, by: [0, 0.1]}]}\n");
    ASSERT_TRUE(motion) << motion.error().message();
    constexpr double kStep = 1e-4;
    const auto y = [&](double time) { return motion->placesAt(time)[0].y; };
    double lastSpeed = 0;
    for (double time = 0; time < 2; time += kStep) {
        const double speed = (y(time + kStep) - y(time)) / kStep;
        const bool goesDown = time + kStep<1.4, rests = time> 0.6 && time + kStep<1.2, comesBack = time> 1.4 + kStep;
        EXPECT_TRUE(!goesDown || speed >= -1e-6) << "at " << time << " it turns back";
        EXPECT_TRUE(!rests || std::abs(speed) < 1e-6) << "at " << time << " it does not rest";
        EXPECT_TRUE(!comesBack || speed <= 1e-6) << "at " << time << " it turns back";
        // The greatest of its accelerations times the step is some 3 pixels a second.
        EXPECT_NEAR(speed, lastSpeed, 5) << "at " << time;
        lastSpeed = speed;
    }
    EXPECT_NEAR(lastSpeed, 0, 1);
}

// Keys on a straight way at an even pace are passed through without a halt: to stop at each of them
// would look like a machine.
TEST_F(MotionFile, does_not_stop_at_a_key_on_its_way) {
    const auto motion = read(
        "  - {name: a, at: [0.7, 0.3], keys: [{time: 0, by: [0, 0]}, {time: 0.5, by: [0, 0.1]}, {time: 1, by: [0, 0.2]}, {time: "
        "1.5, by: [0, 0.3]}]}\n");
    ASSERT_TRUE(motion);
    EXPECT_NEAR(motion->placesAt(1.01)[0].y - motion->placesAt(0.99)[0].y, 0.02 / 0.5 * 30, 0.05);
}

TEST_F(MotionFile, that_loops_goes_on_from_its_end_to_its_beginning) {
    // The same keys, given once and over three rounds: through the first one it passes without a
    // stop, coming from the last.
    const std::vector<double> places = {0.1, 0.3, 0.2, 0};
    std::string round, rounds;
    for (int i = 0; i < 12; ++i) {
        const std::string key =
            fmt::format("{{time: {}, by: [0, {}]}}, ", 0.25 * i + 0.125, places[static_cast<std::size_t>(i % 4)]);
        rounds += key;
        if (i < 4) round += key;
    }
    const auto loop = read("  - {name: a, at: [0.7, 0.3], keys: [" + round + "]}\n", "loop: true\nseconds: 1\n");
    const auto wound = read("  - {name: a, at: [0.7, 0.3], keys: [" + rounds + "]}\n", "seconds: 3\n");
    ASSERT_TRUE(loop && wound);
    for (double time = 0; time < 1; time += 0.01)
        EXPECT_LT(glm::distance(loop->placesAt(time)[0], wound->placesAt(1 + time)[0]), 1e-9) << time;
    EXPECT_LT(glm::distance(loop->placesAt(0)[0], loop->placesAt(1)[0]), 1e-9);
    EXPECT_LT(glm::distance(loop->placesAt(2.3)[0], loop->placesAt(0.3)[0]), 1e-9);
    // A key at the very end that is the one at the beginning changes nothing.
    const auto closed =
        read("  - {name: a, at: [0.7, 0.3], keys: [{time: 0, by: [0, 0]}, {time: 0.5, by: [0, 0.1]}, {time: 1, by: [0, 0]}]}\n",
             "loop: true\nseconds: 1\n");
    const auto open = read("  - {name: a, at: [0.7, 0.3], keys: [{time: 0, by: [0, 0]}, {time: 0.5, by: [0, 0.1]}]}\n",
                           "loop: true\nseconds: 1\n");
    ASSERT_TRUE(closed && open);
    for (const double time : {0.1, 0.6, 0.95}) EXPECT_EQ(closed->placesAt(time), open->placesAt(time));
}

TEST_F(MotionFile, is_refused_with_the_place_the_handle_and_what_to_do) {
    // The box ends at 350 of 400 pixels.
    EXPECT_THAT(refusal("  - {name: ear, at: [0.9, 0.5]}\n"),
                AllOf(HasSubstr("a.motion.yaml:5:21: handles[0].at"), HasSubstr("'ear' is 10 pixels outside the white"),
                      HasSubstr("[0.874, 0.500]")));
    EXPECT_EQ(refusal("  - {name: ear, at: [0.879, 0.5]}\n"), "read")
        << "a pixel and a half: on the outline, as far as a person can tell";
    EXPECT_THAT(refusal("  - {name: ear, at: [0.7, 0.5]}\n  - {name: paw, at: [0.701, 0.5]}\n"),
                AllOf(HasSubstr("a.motion.yaml:6:"), HasSubstr("'ear' and 'paw' are at the same point")));
    EXPECT_THAT(refusal("  - {name: ear, at: [0.7, 0.5]}\n  - {name: ear, at: [0.8, 0.5]}\n"),
                HasSubstr("two handles are called 'ear'"));
    const auto withKeys = [&](const std::string& keys, const std::string& head = "seconds: 2\n") {
        return refusal("  - {name: ear, at: [0.7, 0.5], keys: [" + keys + "]}\n", head);
    };
    EXPECT_THAT(withKeys("{time: 1, by: [0, 0]}, {time: 1, by: [0, 0.1]}"),
                AllOf(HasSubstr("handles[0].keys[1].time"), HasSubstr("'ear'"), HasSubstr("times rise")));
    EXPECT_THAT(withKeys("{time: 3, by: [0, 0]}"), AllOf(HasSubstr("after the end"), HasSubstr("'seconds' longer than 2")));
    EXPECT_THAT(withKeys("{time: 1}"), AllOf(HasSubstr("'ear'"), HasSubstr("either 'by"), HasSubstr("or 'to")));
    EXPECT_THAT(withKeys("{time: 1, by: [0, 0], to: [0.5, 0.5]}"), HasSubstr("either 'by"));
    EXPECT_THAT(withKeys("{time: 1, bye: [0, 0]}"), HasSubstr("unknown key (did you mean 'by'?)"));
    EXPECT_THAT(withKeys("{time: 0, by: [0, 0]}, {time: 2, by: [0, 0.1]}", "seconds: 2\nloop: true\n"),
                AllOf(HasSubstr("loops"), HasSubstr("at 2 s"), HasSubstr("leave the last key out")));
    EXPECT_THAT(refusal("  []\n"), HasSubstr("handles"));
    EXPECT_THAT(refusal("  - {name: ear, at: [0.7, 0.5]}\n", "seconds: 0\n"), HasSubstr("seconds"));
    EXPECT_THAT(refusal("  - {name: ear, at: [0.7, 0.5]}\n", "seconds: 2\nspeed: 3\n"), HasSubstr("unknown key"));
}

}  // namespace
}  // namespace fantascope::theatre
