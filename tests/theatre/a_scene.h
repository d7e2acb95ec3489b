#pragma once

#include "theatre/a_stage.h"
#include "theatre/energy/scene_energy.h"

#include "core/random.h"

#include <numbers>
#include <vector>

namespace fantascope::theatre {

// A target's outline and its measures from a mask of its frame.
inline void setTarget(PoseTarget& target, const BitMask& mask) {
    target.mask = mask;
    target.area = static_cast<double>(mask.count());
    target.contour.clear();
    const ContourDisc disc(kDiscRadius / target.refPixelsPerPixel);
    for (const glm::ivec2 pixel : sampled(outerContour(mask), kContourPoints)) target.contour.push_back(disc.at(mask, pixel));
}
inline void setTarget(PoseProblem& problem, const BitMask& mask) { setTarget(problem.targets[0], mask); }

// Actors of these statures on a stage, in front of a screen of some 7 m x 3.3 m; 128 rows are 2.5 m
// high. The target is yet to be set.
inline PoseProblem aScene(const std::vector<double>& statures) {
    const Stage stage = aStage({0, 0.1, 7});
    const double pixel = 2.5 / 128;
    PoseTarget target{ScreenFrame(stage, -180 * pixel, 170 * pixel, pixel, 360, 170), BitMask(360, 170), 0, {}, 2};
    PoseProblem problem{stage, {std::move(target)}, {}, {}};
    for (const double stature : statures) problem.actors.push_back(humanBody(stature));
    return problem;
}

// T-poses in a row, facing the screen, at z.
inline std::vector<double> aRow(const PoseProblem& problem, const std::vector<double>& x, double z) {
    std::vector<double> poses;
    for (std::size_t i = 0; i < problem.actors.size(); ++i) {
        const Body& body = problem.actors[i];
        const std::vector<double> pose = body.restPose({x[i], body.joints[0].offset.y, z}, rotationOf({0, std::numbers::pi, 0}));
        poses.insert(poses.end(), pose.begin(), pose.end());
    }
    return poses;
}

// Every number changed by up to `size`, within the limits.
inline std::vector<double> nudged(const PoseProblem& problem, std::vector<double> poses, Rng& rng, double size) {
    for (double& number : poses) number += rng.uniform(-size, size);
    std::span<double> rest(poses);
    for (const Body& body : problem.actors) {
        body.limit(rest.first(body.dofs));
        rest = rest.subspan(body.dofs);
    }
    return poses;
}

// A prop whose shape is a box around its frame's origin.
inline Prop aBox(const glm::dvec3& size, const glm::dvec3& place) {
    Stage::Platform box;
    box.size = size;
    return {"box", {}, std::make_shared<const Prop::Shape>(meshOf(box)), std::nullopt, place, {1, 0, 0, 0}};
}

// The shadow of poses becomes the target.
inline void makeTarget(PoseProblem& problem, const std::vector<double>& poses) {
    setTarget(problem, BitMask(problem.targets[0].mask.width(), problem.targets[0].mask.height()));
    SceneEnergy energy(problem);
    energy.pose(poses);
    energy.terms();
    setTarget(problem, energy.shadow());
}

}  // namespace fantascope::theatre
