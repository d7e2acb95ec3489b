// Who walks and drives through the simulated site, and when.

#include "drivers/simulated_stage.h"
#include "drivers/site/walkers.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

namespace fantascope::site {
namespace {

using testing::HasSubstr;

// Where a walker of these keys stands: "x z" of the middle of the head, and "gone" while it is not
// there.
std::string places(const std::string& keys, std::initializer_list<Time> times) {
    const Walker walker = readWalker(ConfigNode::parse("{name: Ann, " + keys + "}", "site.yaml").value()).value();
    std::string text;
    for (const Time time : times) {
        const auto body = walker.bodyAt(time);
        text += body ? fmt::format("{:.1f} {:.1f}; ", body->parts[5].from.x, body->parts[5].from.z) : "gone; ";
    }
    return text;
}

TEST(SiteWalker, walks_its_path_once) {
    EXPECT_EQ(places("path: [[0, 0], [3, 0], [3, 4]], speed: 0.5, at: 10", {9999ms, 10s, 14s, 16s, 18s, 24s, 24001ms}),
              "gone; 0.0 0.0; 2.0 0.0; 3.0 0.0; 3.0 1.0; 3.0 4.0; gone; ");
}

TEST(SiteWalker, walks_to_and_fro_in_a_loop) {
    EXPECT_EQ(places("path: [[0, 0], [3, 0], [3, 4]], speed: 1, at: 0, loop: true", {0s, 6s, 8s, 13s, 15s, 22s}),
              "0.0 0.0; 3.0 3.0; 3.0 3.0; 1.0 0.0; 1.0 0.0; 3.0 3.0; ");
}

// Nothing but the walker changes; and what it hid is there again when it has gone.
TEST(SiteWalker, crosses_the_cameras_picture_and_leaves_it_as_it_was) {
    Stage stage("walkers: [{name: Ann, path: [[-6, 2], [6, 2]], speed: 4, at: 0.25, reflectance: [0, 0, 0]}]");
    stage.show("left", 255);
    stage.show("right", 255);
    const RgbaImage before = stage.look()->image;
    int changed = 0;
    double last = -1;
    while (stage.clock_.now() < 3400ms) {
        const RgbaImage image = stage.look()->image;
        double sum = 0, count = 0;
        for (int y = 0; y < image.height(); ++y)
            for (int x = 0; x < image.width(); ++x)
                if (image.at(x, y) != before.at(x, y)) {
                    sum += x;
                    ++count;
                }
        if (count == 0) continue;
        ++changed;
        EXPECT_GT(sum / count, last) << "from left to right";
        last = sum / count;
    }
    EXPECT_GE(changed, 4);
    EXPECT_EQ(stage.look()->image, before);
}

TEST(SiteWalker, is_refused_without_a_way) {
    const auto walker = [](const std::string& keys) { return refusal(simulationText("walkers: [{name: Ann, " + keys + "}]")); };
    EXPECT_EQ(walker("at: 1, path: [[0, 0], [1, 0]], loop: false, height: 1.2, reflectance: [1, 1, 1]"), "accepted");
    EXPECT_THAT(walker("at: 1"), HasSubstr("walkers[0]: 'path' is missing"));
    EXPECT_THAT(walker("at: 1, path: [[0, 0]]"), HasSubstr("walkers[0].path"));
    EXPECT_THAT(walker("at: 1, path: [[0, 0], [0, 0]]"), HasSubstr("two points of a path that follow each other must differ"));
    EXPECT_THAT(walker("at: 1, path: [[0, 0], [1, 0]], speed: 0"), HasSubstr("speed: 0 is out of range"));
    EXPECT_THAT(walker("at: 1, path: [[0, 0], [1, 0]], hat: 1"), HasSubstr("hat: unknown key"));
}

}  // namespace
}  // namespace fantascope::site
