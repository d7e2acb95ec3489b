#include "theatre/stage/screen.h"

#include "theatre/stage/stage.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace fantascope::theatre {
namespace {

TEST(Screen, stands_where_it_is_said_to_and_looks_where_it_is_turned) {
    const Screen screen{{2.5, 1.5}, -std::numbers::pi / 2};
    // It looks along -x; to the right as seen from there is +z.
    EXPECT_LT(glm::distance(screen.screenFromStage({-6, 0.2, 1.5}), {0, 0.2, 8.5}), 1e-12);
    EXPECT_LT(glm::distance(screen.screenFromStage({2.5, 1, 1.9}), {0.4, 1, 0}), 1e-12);
    const glm::dvec3 point(0.3, 1.1, -0.7);
    EXPECT_LT(glm::distance(screen.stageFromScreen(screen.screenFromStage(point)), point), 1e-12);
    glm::dvec3 outward;
    EXPECT_NEAR(screen.distance({2, 1, 4}, outward), 0.5, 1e-12);
    EXPECT_LT(glm::distance(outward, {-1, 0, 0}), 1e-12);
    Stage stage;
    stage.screens.push_back(screen);
    stage.beams.push_back({{-6, 0.2, 1.5}, 1});
    EXPECT_LT(glm::distance(glm::dvec3(stage.screenFromStage(1) * glm::dvec4(point, 1)), screen.screenFromStage(point)), 1e-12);
    EXPECT_LT(glm::distance(stage.lightOnScreen(1), {0, 0.2, 8.5}), 1e-12);
}

// Found by walking along the ray until it is on the cylinder's other side, which knows nothing of
// arcs and quadratic equations.
TEST(Screen, is_unrolled_as_rays_meet_it) {
    for (const double radius : {4.0, 1.2, -4.0, -2.0})
        for (const glm::dvec3 light : {glm::dvec3(0, 0, 7), glm::dvec3(0.6, 1.5, 3)}) {
            const Screen screen{{}, 0, radius};
            int hits = 0;
            for (double x = -1.5; x <= 1.5; x += 0.25)
                for (const double y : {0.0, 0.8, 2.4}) {
                    const auto unrolled = unrolledFromFlat(screen, light, {x, y});
                    if (!unrolled) continue;
                    const auto beyond = [&](double t) {  // > 0 behind the screen
                        const glm::dvec3 p = glm::mix(light, glm::dvec3(x, y, 0), t);
                        return (std::hypot(p.x, p.z - radius) - std::abs(radius)) * (radius > 0 ? 1 : -1);
                    };
                    // From in front of the screen, which with a hollow one is within it.
                    double before = 0, behind = 1;
                    while (beyond(behind) <= 0) behind += 0.01;
                    while (beyond(before) > 0) before += 0.01;
                    for (int i = 0; i < 60; ++i)
                        (beyond(0.5 * (before + behind)) > 0 ? behind : before) = 0.5 * (before + behind);
                    const glm::dvec3 met = glm::mix(light, glm::dvec3(x, y, 0), before);
                    const double arc = 2 * std::abs(radius) * std::asin(0.5 * std::hypot(met.x, met.z) / std::abs(radius));
                    EXPECT_NEAR(unrolled->x, std::copysign(arc, met.x), 1e-9) << radius << ", " << x << ", " << y;
                    EXPECT_NEAR(unrolled->y, met.y, 1e-9) << radius << ", " << x << ", " << y;
                    EXPECT_LT(glm::distance(screen.surface(*unrolled), met), 1e-9);
                    const auto back = flatFromUnrolled(screen, light, *unrolled);
                    ASSERT_TRUE(back) << radius << ", " << x << ", " << y;
                    EXPECT_LT(glm::distance(*back, {x, y}), 1e-9);
                    ++hits;
                }
            EXPECT_GT(hits, 20) << radius;
        }
}

TEST(Screen, has_no_place_where_the_light_does_not_come) {
    const Screen bulging{{}, 0, -1};
    const glm::dvec3 light(0, 0, 4);
    const double last = std::acos(1.0 / 5);  // of the arc: there the ray is a tangent
    EXPECT_TRUE(flatFromUnrolled(bulging, light, {last - 1e-3, 1}));
    EXPECT_FALSE(flatFromUnrolled(bulging, light, {last + 1e-3, 1}));
    const glm::dvec2 edge = *flatFromUnrolled(bulging, light, {last - 1e-9, 0});
    EXPECT_TRUE(unrolledFromFlat(bulging, light, edge - glm::dvec2(1e-3, 0)));
    EXPECT_FALSE(unrolledFromFlat(bulging, light, edge + glm::dvec2(1e-3, 0)));
    EXPECT_FALSE(flatFromUnrolled({{}, 0, 2}, light, {2 * Screen::kMostArc + 1e-6, 1}));
    EXPECT_EQ(*flatFromUnrolled({}, light, {9, 1}), glm::dvec2(9, 1));
}

TEST(Screen, its_distance_is_that_of_the_nearest_of_its_points) {
    glm::dvec3 outward;
    for (const double radius : {3.0, -3.0})
        for (const double turn : {0.0, 0.7}) {
            const Screen screen{{0.5, -1}, turn, radius};
            for (double x = -1.5; x <= 1.5; x += 0.3)
                for (const double z : {0.9, 1.7, 2.6}) {
                    const glm::dvec3 point = screen.stageFromScreen({x, 1, z});
                    double nearest = 1e9;
                    for (double u = -4.7; u <= 4.7; u += 1e-3)
                        nearest = std::min(nearest, glm::distance(point, screen.stageFromScreen(screen.surface({u, 1}))));
                    EXPECT_NEAR(screen.distance(point, outward), nearest, 1e-4) << radius << ", " << x << ", " << z;
                }
            const glm::dvec3 behind = screen.stageFromScreen({0.2, 1, -0.1});
            EXPECT_LT(screen.distance(behind, outward), -0.09);
            EXPECT_NEAR(screen.distance(behind + 0.2 * outward, outward), 0.2 + screen.distance(behind, outward), 1e-9);
        }
}

// What pushes people out of it must know the way, beside it and within it, too.
TEST(Screen, outwards_is_where_the_distance_grows) {
    glm::dvec3 outward, ignored;
    for (const double radius : {0.0, 2.0, -2.0}) {
        const Screen screen{{0.5, -1}, 0.4, radius};
        for (double x = -3.05; x <= 3.1; x += 0.5)
            for (double z = -1.45; z <= 4; z += 0.5) {
                const glm::dvec3 point = screen.stageFromScreen({x, 1, z});
                screen.distance(point, outward);
                EXPECT_NEAR(glm::length(outward), 1, 1e-12);
                constexpr double kStep = 1e-5;
                for (int axis : {0, 2}) {
                    glm::dvec3 step(0);
                    step[axis] = kStep;
                    EXPECT_NEAR((screen.distance(point + step, ignored) - screen.distance(point - step, ignored)) / (2 * kStep),
                                outward[axis], 1e-4)
                        << radius << ", " << x << ", " << z;
                }
            }
    }
}

}  // namespace
}  // namespace fantascope::theatre
