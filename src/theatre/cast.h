#pragma once

#include "theatre/pose_problem.h"

#include "core/result.h"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fantascope::theatre {

// M_n = (v_0, q_0, q_1 .. q_M) of Won & Lee 2016, section 3: where the root is and how it is turned, in the stage's frame (metres), and how each
// further joint is turned against its parent, in the body's order.
struct ActorPose {
    glm::dvec3 root{0};
    std::vector<glm::dquat> turns;  // of all joints, the root's first
};
ActorPose poseOf(const Body& body, std::span<const double> freedoms);
// The freedoms nearest to a pose, within the joints' limits.
std::vector<double> freedomsOf(const Body& body, const ActorPose& pose);

// What a search for poses leaves behind: who stands how, on which stage, for which target.
struct Cast {
    struct Actor {
        double stature = 0;            // metres, of humanBody()
        std::vector<ActorPose> poses;  // one a frame, as many as the others have
    };
    std::filesystem::path target;  // the silhouette's picture; as the program that reads the file can open it
    double height = 0;             // of the silhouette on the screen, metres
    Stage stage;
    std::optional<std::filesystem::path>
        stageFile;               // of the stage, in the file's folder or below it; none: there is a lamp and nothing else
    double framesPerSecond = 0;  // 0: a still, with one frame
    std::uint64_t seed = 0;
    std::vector<Actor> actors;
};

// *.cast.yaml, docs/cast-format.md; a stage's file is read with it, and must be there when a cast that names it is written. A quaternion that is not of length 1, or outside a joint's limits by more than a thousandth of a degree, is
// refused with its place. Written aside and renamed; the target must lie in the file's folder or below it.
Result<Cast> readCast(const std::filesystem::path& file);
Result<void> writeCast(const std::filesystem::path& file, const Cast& cast);

}  // namespace fantascope::theatre
