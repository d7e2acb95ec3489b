// What is said of a body's balance, against what its skin says by itself.

#include "theatre/skin_stance.h"

#include "theatre/stage/cast.h"

#include "core/geometry.h"
#include "core/random.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <limits>

namespace fantascope::theatre {
namespace {

namespace fs = std::filesystem;

// A box of 40 x 100 x 20 cm whose middle is 2 cm from the long side of what it stands on.
TEST(SkinStance, of_a_box_is_by_hand) {
    std::vector<glm::vec3> vertices;
    for (const float y : {0.0f, 1.0f})
        for (const auto& [x, z] : {std::pair(0.0f, 0.0f), {0.4f, 0.0f}, {0.4f, 0.2f}, {0.0f, 0.2f}})
            vertices.emplace_back(x, y, z);
    const std::vector<glm::uvec3> triangles{{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}, {0, 5, 1}, {0, 4, 5},
                                            {1, 6, 2}, {1, 5, 6}, {2, 7, 3}, {2, 6, 7}, {3, 4, 0}, {3, 7, 4}};
    EXPECT_LT(glm::distance(centreOfVolume(vertices, triangles), {0.2, 0.5, 0.1}), 1e-6);
    EXPECT_NEAR(marginOfMesh(vertices, triangles), 0.1, 1e-6);
    for (std::size_t i = 4; i < 8; ++i) vertices[i].z += 0.16f;  // it leans by 8 cm
    EXPECT_NEAR(marginOfMesh(vertices, triangles), 0.02, 1e-6);
    for (std::size_t i = 4; i < 8; ++i) vertices[i].z += 0.08f;
    EXPECT_NEAR(marginOfMesh(vertices, triangles), -0.02, 1e-6);
}

// Example failure: a thigh that weighs with its buttock, which the skin leaves with the pelvis: 2
// cm in somebody who sits.
TEST(SkinStance, a_body_weighs_where_its_skin_does) {
    const Body body = humanBody(1.75);
    const BodyMesh mesh = humanMesh(body);
    PosedBody posed;
    std::vector<glm::vec3> skin;
    Rng rng(1);
    double squares = 0;
    constexpr int kPoses = 200;
    for (int i = 0; i < kPoses; ++i) {
        std::vector<double> pose = body.restPose({0, 1, 2}, rotationOf({0, 1, 0}));
        for (std::size_t k = Body::kRootDofs; k < pose.size(); ++k) pose[k] += rng.uniform(-1.5, 1.5);
        body.limit(pose);
        posed.pose(body, pose);
        mesh.skin(body, posed, skin);
        const double apart = glm::distance(posed.massCentre(), centreOfVolume(skin, mesh.atRest.triangles));
        EXPECT_LT(apart, 0.009) << i;
        squares += apart * apart;
    }
    EXPECT_LT(std::sqrt(squares / kPoses), 0.005);
}

// By the skins alone.
struct Standing {
    int casts = 0, people = 0;
    double leastMargin = std::numeric_limits<double>::infinity();  // metres
};

// Expects everybody in every frame of every cast below `folder` to stand.
void expectEverybodyStands(const fs::path& folder, Standing& standing) {
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (!entry.path().string().ends_with(".cast.yaml")) continue;
        const auto cast = readCast(entry.path());
        ASSERT_TRUE(cast) << cast.error().message();
        ASSERT_TRUE(cast.value().stage.platforms.empty()) << "the floor is what all stand on here";
        ++standing.casts;
        for (std::size_t a = 0; a < cast.value().actors.size(); ++a) {
            const Cast::Actor& actor = cast.value().actors[a];
            const Body body = humanBody(actor.stature);
            const BodyMesh mesh = humanMesh(body);
            PosedBody posed;
            std::vector<glm::vec3> skin;
            for (std::size_t frame = 0; frame < actor.poses.size(); ++frame, ++standing.people) {
                posed.pose(body, dofsOf(body, actor.poses[frame]));
                mesh.skin(body, posed, skin);
                const double margin = marginOfMesh(skin, mesh.atRest.triangles);
                EXPECT_GT(margin, 0) << fmt::format("{}: actor {}, frame {}", entry.path().string(), a + 1, frame + 1);
                standing.leastMargin = std::min(standing.leastMargin, margin);
            }
        }
    }
}

TEST(SkinStance, everybody_of_the_repositorys_casts_stands) {
    Standing standing;
    for (const char* folder : {"shows", "assets"}) expectEverybodyStands(fs::path(sourceFolder()) / folder, standing);
    EXPECT_GT(standing.people, 300);
    // Casts that were just found and said to be valid.
    if (const char* const more = std::getenv("FANTASCOPE_CASTS")) {
        Standing found;
        expectEverybodyStands(more, found);
        fmt::print("{} casts, {} people: least margin {:.1f} mm\n", found.casts, found.people, 1000 * found.leastMargin);
    }
}

}  // namespace
}  // namespace fantascope::theatre
