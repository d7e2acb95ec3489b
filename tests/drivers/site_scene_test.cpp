#include "drivers/site/scene.h"

#include "core/random.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

namespace fantascope::site {
namespace {

SceneObject sheetAt(float z, glm::vec3 reflectance) {
    return {{{{-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}}, {{0, 1, 2}, {0, 2, 3}}}, reflectance};
}

glm::vec3 randomPoint(Rng& rng, double reach) {
    return {rng.uniform(-reach, reach), rng.uniform(-reach, reach), rng.uniform(-reach, reach)};
}

// The tree of boxes may skip only what the ray cannot hit. Example failure: a box that is flat
// along an axis is never entered.
TEST(Scene, finds_with_its_tree_what_triangle_by_triangle_finds) {
    Rng rng(1);
    std::vector<SceneObject> objects;
    for (int i = 0; i < 300; ++i) {
        const glm::vec3 corner = randomPoint(rng, 5);
        objects.push_back({{{corner, corner + randomPoint(rng, 1), corner + randomPoint(rng, 1)}, {{0, 1, 2}}}, glm::vec3(0.5f)});
    }
    objects.push_back(sheetAt(0, glm::vec3(0.5f)));
    const Scene scene(objects);
    std::vector<Scene> alone;
    for (const SceneObject& object : objects) alone.emplace_back(std::vector{object});

    int met = 0, shadowed = 0;
    for (int i = 0; i < 500; ++i) {
        const glm::vec3 from = randomPoint(rng, 8), to = i % 5 == 0 ? glm::vec3(from.x, from.y, -from.z) : randomPoint(rng, 8);
        const glm::vec3 direction = glm::normalize(to - from);
        float nearest = std::numeric_limits<float>::infinity();
        bool blocked = false;
        for (const Scene& one : alone) {
            if (const auto hit = one.nearest(from, direction)) nearest = std::min(nearest, hit->distance);
            blocked = blocked || one.blocked(from, to);
        }
        const auto hit = scene.nearest(from, direction);
        ASSERT_EQ(hit.has_value(), std::isfinite(nearest));
        ASSERT_EQ(hit ? hit->distance : nearest, nearest);
        ASSERT_EQ(scene.blocked(from, to), blocked);
        met += hit.has_value();
        shadowed += blocked;
    }
    EXPECT_GT(met, 100);
    EXPECT_GT(shadowed, 50);
}

TEST(Scene, gives_the_nearer_surface_with_its_side_towards_the_viewer) {
    const Scene scene({sheetAt(0, {1, 0, 0}), sheetAt(1, {0, 1, 0})});
    const auto front = scene.nearest({0.2f, 0.1f, 5}, {0, 0, -1}), back = scene.nearest({0.2f, 0.1f, -5}, {0, 0, 1});
    ASSERT_TRUE(front && back);
    EXPECT_EQ(front->reflectance, glm::vec3(0, 1, 0));
    EXPECT_FLOAT_EQ(front->distance, 4);
    EXPECT_EQ(front->normal, glm::vec3(0, 0, 1));
    EXPECT_EQ(back->reflectance, glm::vec3(1, 0, 0));
    EXPECT_EQ(back->normal, glm::vec3(0, 0, -1));
    EXPECT_FALSE(scene.nearest({2, 0, 5}, {0, 0, -1})) << "beside the sheets";
}

// Example failure: a surface shadows itself (acne), or the lamp's own housing shadows the lamp.
TEST(Scene, surfaces_at_either_end_cast_no_shadow) {
    const Scene scene({sheetAt(0, glm::vec3(1)), sheetAt(1, glm::vec3(1))});
    EXPECT_FALSE(scene.blocked({0, 0, 0}, {0, 0, 1}));
    EXPECT_TRUE(scene.blocked({0, 0, 0}, {0, 0, 1.01f}));
    EXPECT_TRUE(scene.blocked({0, 0, -0.01f}, {0, 0, 0.5f}));
}

}  // namespace
}  // namespace fantascope::site
