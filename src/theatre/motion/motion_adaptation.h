#pragma once

#include "theatre/search/pose_search.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace fantascope::theatre {

// A silhouette that moves, and the principal poses of its representative frame (Won & Lee 2016,
// section 5).
struct MotionProblem {
    PoseProblem principal;            // its target is the representative frame's
    std::vector<PoseTarget> targets;  // of all frames
    std::size_t representative = 0;   // a frame, from 0
    // The consistent triangulation of the targets' interiors.
    std::vector<glm::uvec3> triangles;
    std::vector<std::vector<glm::dvec2>> corners;  // [frame][corner], on the screen, metres
    bool loops = false;                            // after the last frame comes the first
};

// The poses of a frame.
struct AdaptedFrame {
    std::vector<ActorPose> poses;  // of each actor
    std::vector<double> dofs;      // the same, of all actors, one after the other
    PoseSearch::Quality quality;
    std::int64_t evaluations = 0;
};

// Who watches an adaptation. Both are called from any thread, one at a time: told of each frame
// that is new; and asked now and then, true ends it all with the frames that are done.
struct AdaptationWatch {
    std::function<void(std::size_t frame, const AdaptedFrame&)> tell{};
    std::function<bool()> askStop{};
};

// Algorithm 1 of Won & Lee 2016: principal poses are adapted to the frames beside theirs, those
// poses to the next, forwards and backwards. A frame has two first guesses: through the generalised
// cone, by inverse kinematics; and the poses beside, that follow the triangles on their way in
// small steps. The better is fitted with all terms of the energy; what still does not match is
// searched. What bears at the representative frame is held there throughout. When all frames are
// there each is fitted again between both its neighbours.
//
// A frame's work is a number of evaluations, never a time: the same problem, poses, seed and
// options give the same motion, byte for byte, on any number of threads.
// Thread: reentrant.
class MotionAdaptation {
public:
    struct Options {
        double wanted = 0.95;  // intersection over union: a frame that has it is not searched any further
        int searches = 20;     // steps of local search, for a frame that has not
        int passes = 2;        // of fitting between both neighbours
        int threads = 1;
    };
    using Frames = std::vector<std::optional<AdaptedFrame>>;  // of each frame, as far as there are any

    // `dofs`: the principal poses. `known`: what an earlier run has come to, its `poses`, or
    // nothing; frames that it has are not adapted again.
    static Frames run(const MotionProblem& problem, std::span<const double> dofs, std::uint64_t seed, const Options& options,
                      const AdaptationWatch& watch = {}, Frames known = {});
};

// How fast and how steady a motion is, over all actors, for people and reports.
struct MotionQuality {
    double fastestJoint = 0;     // radians a second, of a joint against its parent, or of the root
    double fastestRoot = 0;      // metres a second
    double farthestContact = 0;  // metres: how far what is held goes from where it was at the representative frame
};
MotionQuality measureMotion(const MotionProblem& problem, const MotionAdaptation::Frames& frames, double framesPerSecond);

}  // namespace fantascope::theatre
