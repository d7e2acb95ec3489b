#include "theatre/motion/motion_cast.h"

#include <algorithm>

namespace fantascope::theatre {

std::vector<std::size_t> playedFrames(const MotionProblem& motion, const MotionAdaptation::Frames& frames) {
    const std::size_t all = frames.size();
    std::size_t first = motion.representative;
    for (std::size_t steps = 1; steps < all && frames[(first + all - 1) % all] && (first > 0 || motion.loops); ++steps)
        first = (first + all - 1) % all;
    if (std::all_of(frames.begin(), frames.end(), [](const auto& frame) { return frame.has_value(); })) first = 0;
    std::vector<std::size_t> played;
    for (std::size_t i = first; played.size() < all && frames[i]; i = (i + 1) % all) {
        played.push_back(i);
        if (i + 1 == all && !motion.loops) break;
    }
    return played;
}

MotionAdaptation::Frames resumedFrames(const MotionProblem& motion, std::span<const double> principal, const Cast& written) {
    if (!written.sequence || written.actors.size() != motion.principal.actors.size()) return {};
    const auto& [file, representative, first] = *written.sequence;
    const std::size_t count = written.actors[0].poses.size(), all = motion.targets.size();
    const std::size_t own = (representative + all - first) % all;  // index of the representative frame's poses
    if (representative != motion.representative || count >= all || first >= all || own >= count) return {};
    for (std::size_t a = 0; a < written.actors.size(); ++a) {
        const Body& body = motion.principal.actors[a];
        const auto his = principal.subspan(motion.principal.firstDof(a), body.dofs);
        const ActorPose there = written.actors[a].poses[own], wanted = poseOf(body, his);
        if (there.root != wanted.root || there.turns != wanted.turns) return {};
    }
    MotionAdaptation::Frames resumed(all);
    for (std::size_t i = 0; i < count; ++i)
        if (i != own)
            for (std::vector<ActorPose>& poses = resumed[(first + i) % all].emplace().poses;
                 const Cast::Actor& actor : written.actors)
                poses.push_back(actor.poses[i]);
    return resumed;
}

}  // namespace fantascope::theatre
