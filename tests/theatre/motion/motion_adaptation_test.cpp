#include "theatre/motion/motion_adaptation.h"

#include "theatre/a_scene.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <vector>

namespace fantascope::theatre {
namespace {

constexpr std::size_t kFrames = 7, kRepresentative = 2;

// Two people side by side; one raises an arm and bends his knees, frame by frame, and each frame's
// shadow is its target.
struct Dance {
    MotionProblem motion{aScene({1.7, 1.6}), {}, kRepresentative, {}, {}};
    std::vector<std::vector<double>> wanted;

    Dance() {
        motion.principal.buildSkins();
        for (std::size_t i = 0; i < kFrames; ++i) {
            PoseProblem problem = motion.principal;
            makeTarget(problem, wanted.emplace_back(poseAt(static_cast<double>(i))));
            motion.targets.push_back(problem.targets[0]);
        }
        motion.principal.targets[0] = motion.targets[kRepresentative];
        // A triangulation that stays: the fit has to do it all.
        motion.triangles = {{0, 1, 2}, {0, 2, 3}};
        motion.corners.assign(kFrames, {{-3, 0}, {3, 0}, {3, 3}, {-3, 3}});
    }

    std::vector<double> poseAt(double frame) const {
        const Body& body = motion.principal.actors[0];
        std::vector<double> pose = aRow(motion.principal, {-0.7, 0.7}, 2);
        for (const char* arm : {"left shoulder", "right shoulder"})
            pose[body.joints[body.joint(arm)].first] += 0.12 * (frame - kRepresentative);
        pose[body.joints[body.joint("left elbow")].first] += 0.1 + 0.1 * frame;
        return pose;
    }
};

TEST(MotionAdaptation, follows_a_shadow_that_moves) {
    const Dance dance;
    std::vector<std::size_t> told;
    const auto frames = MotionAdaptation::run(dance.motion, dance.wanted[kRepresentative], 1, {.passes = 0},
                                              {.tell = [&](std::size_t frame, const AdaptedFrame&) { told.push_back(frame); }});
    EXPECT_THAT(told, testing::UnorderedElementsAre(0u, 1u, 3u, 4u, 5u, 6u));
    ASSERT_EQ(frames.size(), kFrames);
    const double still = PoseSearch::measure(
                             [&] {
                                 PoseProblem problem = dance.motion.principal;
                                 problem.targets[0] = dance.motion.targets.back();
                                 return problem;
                             }(),
                             dance.wanted[kRepresentative])
                             .iou;
    EXPECT_LT(still, 0.93) << "who stays as he was does not match";
    for (std::size_t i = 0; i < kFrames; ++i) EXPECT_GT(frames[i]->quality.iou, 0.96) << i;
    const MotionQuality quality = measureMotion(dance.motion, frames, 12);
    EXPECT_LT(quality.farthestContact, 0.005);
    EXPECT_LT(quality.fastestJoint, 12 * 0.3) << "as fast as the shadow asks for, and not much more";
}

// Arms that go up by so much from frame to frame that their shadows do not even touch: who knows
// the way follows, who does not stays behind.
TEST(MotionAdaptation, follows_the_triangles_on_their_way) {
    Dance dance;
    MotionProblem& motion = dance.motion;
    std::vector<glm::uvec3> triangles;
    std::vector<std::vector<glm::dvec2>> corners(kFrames);
    PosedBody posed;
    for (std::size_t i = 0; i < kFrames; ++i) {
        const Body& body = motion.principal.actors[0];
        std::vector<double>& pose = dance.wanted[i] = dance.poseAt(kRepresentative);
        for (const char* arm : {"left shoulder", "right shoulder"})
            pose[body.joints[body.joint(arm)].first] += 0.35 * (static_cast<double>(i) - kRepresentative);
        PoseProblem problem = motion.principal;
        makeTarget(problem, pose);
        motion.targets[i] = problem.targets[0];
        // Two triangles for each capsule's shadow.
        for (std::size_t a = 0; a < 2; ++a) {
            const Body& own = motion.principal.actors[a];
            posed.pose(own, std::span(pose).subspan(motion.principal.firstDof(a), own.dofs));
            for (const PlacedCapsule& capsule : posed.capsules()) {
                const ScreenFrame& frame = motion.targets[i].frame;
                const auto shadow = [&](const glm::dvec3& point) {
                    const glm::dvec2 pixel = frame.shadow(point);
                    return frame.metresAt(pixel);
                };
                const glm::dvec2 from = shadow(capsule.from), to = shadow(capsule.to), along = to - from;
                const glm::dvec2 across =
                    1.4 * capsule.fromRadius * glm::dvec2(-along.y, along.x) / std::max(1e-3, glm::length(along));
                const auto first = static_cast<unsigned>(corners[i].size());
                for (const glm::dvec2 corner : {from - across, to - across, to + across, from + across})
                    corners[i].push_back(corner);
                if (i == 0) triangles.insert(triangles.end(), {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
            }
        }
    }
    motion.principal.targets[0] = motion.targets[kRepresentative];
    const auto worst = [&] {
        double least = 1;
        for (const auto& frame : MotionAdaptation::run(motion, dance.wanted[kRepresentative], 1, {.searches = 0, .passes = 0}))
            least = std::min(least, frame->quality.iou);
        return least;
    };
    const double still = worst();
    motion.triangles = triangles, motion.corners = corners;
    const double carried = worst();
    EXPECT_GT(carried, 0.93);
    EXPECT_LT(still, carried - 0.03);
}

TEST(MotionAdaptation, is_the_same_on_any_number_of_threads) {
    const Dance dance;
    const auto bytes = [&](int threads) {
        std::vector<double> all;
        for (const auto& frame :
             MotionAdaptation::run(dance.motion, dance.wanted[kRepresentative], 4, {.passes = 1, .threads = threads}))
            all.insert(all.end(), frame->dofs.begin(), frame->dofs.end());
        return all;
    };
    EXPECT_EQ(bytes(1), bytes(2));
}

// Frames that were found each for itself tremble; fitted between both their neighbours they do so
// less, and match no worse.
TEST(MotionAdaptation, is_steadier_for_its_passes) {
    const Dance dance;
    Rng rng(7);
    MotionAdaptation::Frames trembling(kFrames);
    for (std::size_t i = 0; i < kFrames; ++i) {
        auto& frame = trembling[i].emplace();
        frame.dofs = i == kRepresentative ? dance.wanted[i] : nudged(dance.motion.principal, dance.wanted[i], rng, 0.04);
        for (std::size_t a = 0; a < 2; ++a) {
            const Body& body = dance.motion.principal.actors[a];
            frame.poses.push_back(poseOf(body, std::span(frame.dofs).subspan(dance.motion.principal.firstDof(a), body.dofs)));
        }
    }
    const auto tremor = [&](const MotionAdaptation::Frames& frames) {
        double sum = 0;
        for (std::size_t i = 1; i < kFrames; ++i)
            for (std::size_t a = 0; a < 2; ++a) {
                const Body& body = dance.motion.principal.actors[a];
                const std::size_t first = dance.motion.principal.firstDof(a);
                const auto ownOf = [&](std::size_t frame) { return std::span(frames[frame]->dofs).subspan(first, body.dofs); };
                sum += poseDifference(body, ownOf(i), poseOf(body, ownOf(i - 1)));
            }
        return sum;
    };
    const auto run = [&](int passes) {
        return MotionAdaptation::run(dance.motion, dance.wanted[kRepresentative], 1, {.passes = passes}, {}, trembling);
    };
    const auto as = run(0), after = run(2);
    EXPECT_NEAR(tremor(as), tremor(trembling), 1e-9) << "what is known is not adapted again";
    EXPECT_LT(tremor(after), 0.6 * tremor(as));
    for (std::size_t i = 0; i < kFrames; ++i) EXPECT_GT(after[i]->quality.iou, 0.95) << i;
}

// Who is told to stop keeps what there is, and goes on from it.
TEST(MotionAdaptation, resumes_from_what_is_there) {
    const Dance dance;
    const MotionAdaptation::Options options{.passes = 0};
    const auto run = [&](const AdaptationWatch& watch, MotionAdaptation::Frames known) {
        return MotionAdaptation::run(dance.motion, dance.wanted[kRepresentative], 1, options, watch, std::move(known));
    };
    const auto whole = run({}, {});
    std::size_t told = 0;
    const auto count = [&](std::size_t, const AdaptedFrame&) { ++told; };
    auto part = run({count, [&] { return told >= 2; }}, {});
    EXPECT_EQ(told, 2u);
    EXPECT_EQ(std::count_if(part.begin(), part.end(), [](const auto& frame) { return frame.has_value(); }), 3);
    told = 0;
    const auto rest = run({count, {}}, std::move(part));
    EXPECT_EQ(told, kFrames - 3);
    for (std::size_t i = 0; i < kFrames; ++i) EXPECT_EQ(rest[i]->dofs, whole[i]->dofs) << i;
}

}  // namespace
}  // namespace fantascope::theatre
