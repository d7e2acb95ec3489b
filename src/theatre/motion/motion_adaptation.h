#pragma once

#include "theatre/search/pose_search.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace fantascope::theatre {

// A moving silhouette, and the problem of its representative frame (Won & Lee 2016, section 5).
struct MotionProblem {
    PoseProblem principal;            // its target is the representative frame's
    std::vector<PoseTarget> targets;  // of all frames
    std::size_t representative = 0;   // index of the representative frame, from 0
    // The consistent triangulation of the targets' interiors.
    std::vector<glm::uvec3> triangles;
    std::vector<std::vector<glm::dvec2>> corners;  // [frame][corner], on the screen, metres
    bool loops = false;                            // after the last frame comes the first
};

// The poses of a frame.
struct AdaptedFrame {
    std::vector<ActorPose> poses;  // of each actor
    std::vector<double> dofs;      // the same as degrees of freedom, one actor after the other
    PoseSearch::Quality quality;
    std::int64_t evaluations = 0;
};

// Callbacks of an adaptation. They are called from any thread, one at a time. `tell` gets each new
// frame. `askStop` is called now and then; true ends the run with the frames that are done.
struct AdaptationWatch {
    std::function<void(std::size_t frame, const AdaptedFrame&)> tell{};
    std::function<bool()> askStop{};
};

// Algorithm 1 of Won & Lee 2016: principal poses are adapted from frame to adjacent frame, forwards
// and backwards. A frame has two initial guesses: one through the generalised cone, by inverse
// kinematics; and the adjacent frame's poses, which follow the moving triangles in small steps.
// Both are fitted with all terms of the energy, and the better is kept. A frame that still does not
// match is searched. Contacts at the representative frame are held throughout. When all frames are
// done, each is fitted again between both its neighbours.
//
// A frame's work is a number of evaluations, never a time: the same problem, poses, seed and
// options give the same motion, byte for byte, on any number of threads.
// Thread: reentrant.
class MotionAdaptation {
public:
    struct Options {
        double wanted = 0.95;  // intersection over union from which a frame is not searched any further
        int searches = 20;     // steps of local search, for a frame below `wanted`
        int passes = 2;        // passes of fitting between both neighbours
        int threads = 1;
    };
    using Frames = std::vector<std::optional<AdaptedFrame>>;  // one for each frame; none: not adapted

    // `dofs`: the principal poses. `known`: the frames of an earlier run, with their `poses`, or
    // empty. Known frames are not adapted again.
    static Frames run(const MotionProblem& problem, std::span<const double> dofs, std::uint64_t seed, const Options& options,
                      const AdaptationWatch& watch = {}, Frames known = {});
};

// The speed and steadiness of a motion over all actors, for people and reports.
struct MotionQuality {
    double fastestJoint = 0;     // radians a second, of a joint relative to its parent, or of the root
    double fastestRoot = 0;      // metres a second
    double farthestContact = 0;  // metres: greatest drift of a held contact from its place at the representative frame
};
MotionQuality measureMotion(const MotionProblem& problem, const MotionAdaptation::Frames& frames, double framesPerSecond);

}  // namespace fantascope::theatre
