#include "theatre/motion/motion_cast.h"

#include "theatre/a_scene.h"

#include <gmock/gmock.h>

#include <vector>

namespace fantascope::theatre {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::size_t kFrames = 5, kRepresentative = 2;

// One person who goes to the right, frame by frame. Nothing here looks at the targets.
struct Walk {
    MotionProblem motion{aScene({1.7}), {}, kRepresentative, {}, {}};
    std::vector<double> principal = at(kRepresentative);
    MotionAdaptation::Frames frames{kFrames};

    Walk() { motion.targets.assign(kFrames, motion.principal.targets[0]); }

    std::vector<double> at(std::size_t frame) const { return aRow(motion.principal, {0.1 * static_cast<double>(frame)}, 2); }
    ActorPose poseAt(std::size_t frame) const { return poseOf(motion.principal.actors[0], at(frame)); }
    void find(std::initializer_list<std::size_t> which) {
        for (const std::size_t frame : which) frames[frame].emplace().poses = {poseAt(frame)};
    }
    std::vector<std::size_t> played() const { return playedFrames(motion, frames); }
    // As 'adapt' writes it.
    Cast written() const {
        Cast cast;
        cast.actors.push_back({1.7, {}});
        for (const std::size_t frame : played()) cast.actors[0].poses.push_back(frames[frame]->poses[0]);
        cast.sequence = {"sequence.yaml", kRepresentative, played().front()};
        return cast;
    }
    std::vector<std::size_t> resumed(const Cast& cast) const {
        std::vector<std::size_t> there;
        const MotionAdaptation::Frames known = resumedFrames(motion, principal, cast);
        for (std::size_t i = 0; i < known.size(); ++i)
            if (known[i]) {
                EXPECT_EQ(known[i]->poses[0].root, poseAt(i).root) << i;
                there.push_back(i);
            }
        return there;
    }
};

// Example failure: a frame that was found beyond a gap is played after one that it does not follow.
TEST(MotionCast, plays_the_frames_that_hang_together_with_the_representative_one) {
    Walk walk;
    walk.find({0, 2, 3});
    EXPECT_THAT(walk.played(), ElementsAre(2, 3));
    walk.find({1});
    EXPECT_THAT(walk.played(), ElementsAre(0, 1, 2, 3));
    walk.find({4});
    EXPECT_THAT(walk.played(), ElementsAre(0, 1, 2, 3, 4));
}

TEST(MotionCast, plays_a_loop_over_its_end) {
    Walk walk;
    walk.motion.loops = true;
    walk.find({0, 1, 2, 4});
    EXPECT_THAT(walk.played(), ElementsAre(4, 0, 1, 2));
    walk.motion.loops = false;
    EXPECT_THAT(walk.played(), ElementsAre(0, 1, 2));
}

// The representative frame is known from the principal poses.
TEST(MotionCast, resumes_with_the_frames_that_were_written) {
    Walk walk;
    walk.find({1, 2, 3});
    EXPECT_THAT(walk.resumed(walk.written()), ElementsAre(1, 3));
    walk.motion.loops = true;
    walk.find({0, 4});
    walk.frames[3].reset();
    EXPECT_THAT(walk.resumed(walk.written()), ElementsAre(0, 1, 4));
}

// Example failure: after other poses were found the motion goes on with frames of the old ones.
TEST(MotionCast, resumes_nothing_of_another_motion_or_of_a_whole_one) {
    Walk walk;
    walk.find({1, 2, 3});
    const Cast good = walk.written();
    Cast other = good;
    other.sequence->representative = 3;
    EXPECT_THAT(walk.resumed(other), IsEmpty());
    other = good;
    other.sequence.reset();
    EXPECT_THAT(walk.resumed(other), IsEmpty());
    other = good;
    other.actors[0].poses[1].root.x += 1e-9;
    EXPECT_THAT(walk.resumed(other), IsEmpty());
    other = good;
    other.actors.push_back(other.actors[0]);
    EXPECT_THAT(walk.resumed(other), IsEmpty());
    walk.find({0, 4});
    EXPECT_THAT(walk.resumed(walk.written()), IsEmpty());
}

}  // namespace
}  // namespace fantascope::theatre
