#include "pattern/motion/pattern_motion.h"

#include "allocations.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <thread>

namespace fantascope::pattern {
namespace {

using namespace std::chrono_literals;

// Instances on a grid, assigned to `groups` groups in turn. Motion needs no shapes.
ShapePattern gridPattern(std::uint32_t instances, std::uint32_t groups) {
    ShapePattern pattern;
    pattern.width = 160;
    pattern.height = 90;
    pattern.seed = 5;
    pattern.groups = groups;
    pattern.motion.frames = 240;
    for (std::uint32_t i = 0; i < instances; ++i) {
        ShapeInstance instance;
        instance.id = 100 + i;
        instance.group = i % groups;
        instance.centre = {0.1 * (i % 16), 0.1 * (i / 16 % 10)};
        instance.size = 0.01 + 0.0001 * i;
        instance.rotation = {0.1 * i, -0.2, 0.3};
        pattern.instances.push_back(instance);
    }
    return pattern;
}

std::vector<InstancePose> poses(const PatternMotion& motion, Time time, std::size_t count, const Wind& wind = {}) {
    std::vector<InstancePose> out(count);
    motion.posesAt(time, wind, out);
    return out;
}

bool sameBytes(const InstancePose& a, const InstancePose& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

// The movement of an instance: its pose relative to its rest.
struct Movement {
    glm::dvec2 shift;
    glm::dvec3 turn;
};
std::vector<Movement> movements(const ShapePattern& pattern, const PatternMotion& motion, std::size_t instance, int samples,
                                const Wind& wind = {}) {
    std::vector<Movement> result;
    const ShapeInstance& rest = pattern.instances[instance];
    for (int k = 0; k < samples; ++k) {
        const InstancePose pose = poses(motion, motion.period() * k / samples, pattern.instances.size(), wind)[instance];
        result.push_back({pose.centre - rest.centre, pose.rotation - rest.rotation});
    }
    return result;
}

// Only the group moves: the local ranges are zero.
ShapePattern groupsOnly(std::uint32_t instances, std::uint32_t groups) {
    ShapePattern pattern = gridPattern(instances, groups);
    for (AxisMotion* axis : {&pattern.motion.localTranslation, &pattern.motion.localTilt, &pattern.motion.localTurn})
        axis->range = 0;
    return pattern;
}

constexpr std::size_t kCount = 40;

TEST(PatternMotion, loops_over_frames_by_rate_seconds) {
    ShapePattern pattern = gridPattern(1, 1);
    EXPECT_EQ(PatternMotion(pattern).period(), 8s);
    pattern.motion.frames = 2000;
    EXPECT_EQ(PatternMotion(pattern).period(), 66'666'666'667ns);
}

// A frame after a seek equals the frame of continuous play. Distant and negative times are no
// exception.
TEST(PatternMotion, seeks_to_what_it_plays) {
    const ShapePattern pattern = gridPattern(kCount, 3);
    const PatternMotion motion(pattern);
    const std::vector<Time> times{0s, 1ns, 16'666'667ns, 4s, 7'999'999'999ns};
    std::vector<std::vector<InstancePose>> played;
    for (const Time time : times) played.push_back(poses(motion, time, kCount));
    for (const std::int64_t loops : {1L, -1L, 1'000'000L, -1'000'000'000L})
        for (std::size_t k = times.size(); k-- > 0;) {
            const auto sought = poses(motion, times[k] + loops * motion.period(), kCount);
            for (std::size_t i = 0; i < kCount; ++i)
                ASSERT_TRUE(sameBytes(sought[i], played[k][i])) << loops << " loops, time " << k;
        }
    for (const Time time : {Time::min(), Time::max()})
        for (const InstancePose& pose : poses(motion, time, kCount)) EXPECT_TRUE(std::isfinite(pose.centre.x));
}

// There is no seam where the loop closes, nor at any sample: within a nanosecond nothing moves
// farther than its velocity allows.
TEST(PatternMotion, moves_continuously_through_the_loop_s_end) {
    const ShapePattern pattern = gridPattern(kCount, 3);
    const PatternMotion motion(pattern);
    for (const Time time : {motion.period(), tickTime(17, pattern.motion.rate)}) {
        const auto before = poses(motion, time - 1ns, kCount), at = poses(motion, time, kCount),
                   after = poses(motion, time + 1ns, kCount);
        const auto early = poses(motion, time - 1us, kCount), late = poses(motion, time + 1us, kCount);
        for (std::size_t i = 0; i < kCount; ++i) {
            EXPECT_LT(glm::length(at[i].centre - before[i].centre), 1e-9);
            EXPECT_LT(glm::length(after[i].centre - at[i].centre), 1e-9);
            // Nor does the velocity jump: within a microsecond it changes only by acceleration and
            // rounding.
            EXPECT_LT(glm::length((late[i].centre - at[i].centre) - (at[i].centre - early[i].centre)), 1e-11);
            EXPECT_LT(glm::length((late[i].rotation - at[i].rotation) - (at[i].rotation - early[i].rotation)), 1e-9);
        }
    }
}

// Example failure: streams derive from the index in the list, or all share one engine; then a new
// instance changes all that follow it.
TEST(PatternMotion, of_an_instance_depends_on_no_other) {
    ShapePattern pattern = gridPattern(kCount, 3);
    const PatternMotion before(pattern);
    ShapeInstance added;
    added.id = 7;
    added.group = 2;
    pattern.instances.insert(pattern.instances.begin() + 5, added);
    pattern.instances.erase(pattern.instances.begin());
    const PatternMotion after(pattern);
    for (const Time time : {0s, 3s, 5s}) {
        const auto old = poses(before, time, kCount), now = poses(after, time, kCount);
        for (std::size_t i = 1; i < kCount; ++i) EXPECT_TRUE(sameBytes(old[i], now[i < 5 ? i - 1 : i])) << "instance " << i;
    }
}

TEST(PatternMotion, is_the_same_on_any_number_of_threads) {
    const ShapePattern pattern = gridPattern(kCount, 3);
    const PatternMotion one(pattern, 1), many(pattern, 5);
    for (const Time time : {0s, 3s}) {
        const auto a = poses(one, time, kCount), b = poses(many, time, kCount);
        for (std::size_t i = 0; i < kCount; ++i) EXPECT_TRUE(sameBytes(a[i], b[i]));
    }
}

TEST(PatternMotion, can_be_asked_from_many_threads_at_once) {
    const ShapePattern pattern = gridPattern(kCount, 3);
    const PatternMotion motion(pattern);
    const auto expected = poses(motion, 2s, kCount);
    std::vector<std::vector<InstancePose>> seen(4);
    {
        std::vector<std::jthread> threads;
        for (auto& out : seen)
            threads.emplace_back([&] {
                for (int k = 0; k < 50; ++k) poses(motion, k * 100ms, kCount);
                out = poses(motion, 2s, kCount);
            });
    }
    for (const auto& out : seen)
        for (std::size_t i = 0; i < kCount; ++i) EXPECT_TRUE(sameBytes(out[i], expected[i]));
}

TEST(PatternMotion, differs_from_seed_to_seed_and_from_instance_to_instance) {
    ShapePattern pattern = gridPattern(2, 1);
    const auto first = movements(pattern, PatternMotion(pattern), 0, 4),
               second = movements(pattern, PatternMotion(pattern), 1, 4);
    pattern.seed += 1;
    const auto reseeded = movements(pattern, PatternMotion(pattern), 0, 4);
    EXPECT_GT(glm::length(first[1].shift - second[1].shift), 1e-6);
    EXPECT_GT(glm::length(first[1].shift - reseeded[1].shift), 1e-6);
    EXPECT_GT(glm::length(first[1].turn - reseeded[1].turn), 1e-6);
}

// The correlation of two movements: 1 if they are proportional.
template <class First, class Second>
double correlation(const std::vector<Movement>& path, First first, Second second) {
    double both = 0, firsts = 0, seconds = 0;
    for (const Movement& movement : path) {
        const double a = first(movement), b = second(movement);
        both += a * b, firsts += a * a, seconds += b * b;
    }
    return std::abs(both) / std::sqrt(firsts * seconds);
}

// Every axis has an excitation of its own. Example failure: two axes share a stream, so that they
// move along a line or turn as one.
TEST(PatternMotion, moves_each_axis_by_itself) {
    ShapePattern local = gridPattern(1, 1), group = groupsOnly(1, 1);
    local.motion.groupMajor.range = local.motion.groupMinor.range = 0;
    local.motion.localTilt = local.motion.localTurn = local.motion.localTranslation;
    const auto path = movements(local, PatternMotion(local), 0, 200);
    const auto axis = [](int index) {
        return [index](const Movement& movement) { return index < 2 ? movement.shift[index] : movement.turn[index - 2]; };
    };
    for (int a = 0; a < 5; ++a)
        for (int b = 0; b < a; ++b) EXPECT_LT(correlation(path, axis(a), axis(b)), 0.9) << "local axes " << b << " and " << a;
    EXPECT_LT(correlation(movements(group, PatternMotion(group), 0, 200), axis(0), axis(1)), 0.9) << "major and minor";
}

TEST(PatternMotion, stays_within_group_and_local_ranges_all_the_loop) {
    ShapePattern pattern = gridPattern(8, 2);
    MotionSettings& motion = pattern.motion;
    // The magnitudes are so large that every range is reached.
    for (AxisMotion* axis :
         {&motion.groupMajor, &motion.groupMinor, &motion.localTranslation, &motion.localTilt, &motion.localTurn})
        axis->magnitude = 100;
    const PatternMotion moving(pattern);
    // Allows for rounding to float.
    constexpr double kOne = 1 + 1e-6;
    const double along = motion.groupMajor.range + motion.localTranslation.range,
                 across = motion.groupMinor.range + motion.localTranslation.range;
    double largestTilt = 0;
    for (std::size_t i = 0; i < pattern.instances.size(); ++i)
        for (const Movement& movement : movements(pattern, moving, i, 2400)) {
            ASSERT_LE(std::abs(movement.shift.x), along * kOne);
            ASSERT_LE(std::abs(movement.shift.y), across * kOne);
            ASSERT_LE(std::abs(movement.turn.x), motion.localTilt.range * kOne);
            ASSERT_LE(std::abs(movement.turn.y), motion.localTilt.range * kOne);
            ASSERT_LE(std::abs(movement.turn.z), motion.localTurn.range * kOne);
            largestTilt = std::max(largestTilt, std::abs(movement.turn.x));
        }
    EXPECT_GT(largestTilt, 0.99 * motion.localTilt.range);
}

// The artist's direction: from the canvas's x axis towards its y axis, which points down.
// Example failure: the angle is measured the other way round, or major and minor are exchanged.
TEST(PatternMotion, moves_groups_along_the_direction) {
    ShapePattern pattern = groupsOnly(6, 3);
    const double direction = std::numbers::pi / 6;
    pattern.motion.direction = direction;
    const PatternMotion motion(pattern);
    const glm::dvec2 along(std::cos(direction), std::sin(direction)), across(-std::sin(direction), std::cos(direction));
    for (std::size_t i = 0; i < 3; ++i) {
        double major = 0, minor = 0;
        for (const Movement& movement : movements(pattern, motion, i, 480)) {
            major = std::max(major, std::abs(glm::dot(movement.shift, along)));
            minor = std::max(minor, std::abs(glm::dot(movement.shift, across)));
        }
        EXPECT_LE(major, pattern.motion.groupMajor.range * (1 + 1e-6));
        EXPECT_LE(minor, pattern.motion.groupMinor.range * (1 + 1e-6));
        EXPECT_GT(major, 1.5 * minor);
    }
}

TEST(PatternMotion, moves_the_instances_of_a_group_together) {
    const ShapePattern pattern = groupsOnly(6, 3);
    const PatternMotion motion(pattern);
    const auto first = movements(pattern, motion, 0, 8), same = movements(pattern, motion, 3, 8),
               other = movements(pattern, motion, 1, 8);
    for (std::size_t k = 0; k < 8; ++k) EXPECT_LT(glm::length(first[k].shift - same[k].shift), 1e-15);
    EXPECT_GT(glm::length(first[1].shift - other[1].shift), 1e-6);
}

// "The movement of a shape instance is added on top of its group movement."
TEST(PatternMotion, adds_the_local_movement_to_that_of_the_group) {
    ShapePattern whole = gridPattern(3, 2), local = whole;
    local.motion.groupMajor.range = local.motion.groupMinor.range = 0;
    const ShapePattern groups = groupsOnly(3, 2);
    const auto sum = movements(whole, PatternMotion(whole), 1, 50), own = movements(local, PatternMotion(local), 1, 50),
               carried = movements(groups, PatternMotion(groups), 1, 50);
    for (std::size_t k = 0; k < sum.size(); ++k) {
        EXPECT_LT(glm::length(sum[k].shift - own[k].shift - carried[k].shift), 1e-8);
        EXPECT_EQ(sum[k].turn, own[k].turn);
        EXPECT_EQ(carried[k].turn, glm::dvec3(0));
    }
}

TEST(PatternMotion, keeps_the_size_of_every_instance) {
    const ShapePattern pattern = gridPattern(5, 1);
    const auto moved = poses(PatternMotion(pattern), 3s, 5);
    for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(moved[i].size, pattern.instances[i].size);
}

// All displacements are proportional to the strength, above 1 too. Example failure: the range clips
// them, or the strength scales only the range.
TEST(PatternMotion, is_proportional_to_the_strength_of_the_wind) {
    const ShapePattern pattern = gridPattern(kCount, 3);
    const PatternMotion motion(pattern);
    for (const double strength : {0.25, 1.0, 3.5})
        for (const std::size_t instance : {0u, 17u}) {
            const auto usual = movements(pattern, motion, instance, 50),
                       blown = movements(pattern, motion, instance, 50, {.strength = strength});
            for (std::size_t k = 0; k < usual.size(); ++k) {
                EXPECT_LT(glm::length(blown[k].shift - strength * usual[k].shift), 1e-15);
                EXPECT_LT(glm::length(blown[k].turn - strength * usual[k].turn), 1e-14);
            }
        }
}

// Example failure: a group that still drifts, or an angle that keeps its last value.
TEST(PatternMotion, without_wind_is_rest) {
    const ShapePattern pattern = gridPattern(kCount, 3);
    const PatternMotion motion(pattern);
    for (const Time time : {0s, 3s, 5s}) {
        const auto still = poses(motion, time, kCount, {.strength = 0});
        for (std::size_t i = 0; i < kCount; ++i) {
            EXPECT_EQ(still[i].centre, pattern.instances[i].centre);
            EXPECT_EQ(still[i].rotation, pattern.instances[i].rotation);
        }
    }
}

// A wind along a pattern's own direction changes nothing; any other turns the groups' movement and
// leaves the local movement alone. Example failure: the pattern's direction and the wind's add up.
TEST(PatternMotion, groups_sway_along_the_wind) {
    ShapePattern pattern = groupsOnly(6, 3);
    pattern.motion.direction = 0.7;
    ShapePattern turned = pattern;
    turned.motion.direction = 2.1;
    const PatternMotion motion(pattern), expected(turned);
    const Wind across{.ownDirection = 0, .direction = {std::cos(2.1), std::sin(2.1)}};
    for (std::size_t i = 0; i < 3; ++i) {
        const auto blown = movements(pattern, motion, i, 50, across), own = movements(turned, expected, i, 50);
        for (std::size_t k = 0; k < own.size(); ++k) EXPECT_LT(glm::length(blown[k].shift - own[k].shift), 1e-15);
    }

    ShapePattern local = gridPattern(3, 2);
    local.motion.groupMajor.range = local.motion.groupMinor.range = 0;
    const PatternMotion still(local);
    EXPECT_EQ(poses(still, 3s, 3, across)[1].centre, poses(still, 3s, 3)[1].centre);
    EXPECT_EQ(poses(still, 3s, 3, across)[1].rotation, poses(still, 3s, 3)[1].rotation);
}

// The render thread calls it for every frame and must not wait for the heap.
TEST(PatternMotion, asking_allocates_nothing) {
    const ShapePattern pattern = gridPattern(kCount, 3);
    const PatternMotion motion(pattern);
    std::vector<InstancePose> out(kCount);
    const std::int64_t before = allocationsSoFar();
    for (Time time{}; time < 20s; time += 7ms)
        motion.posesAt(time, {.strength = 2, .ownDirection = 0.5, .direction = {0.5, 0}}, out);
    EXPECT_EQ(allocationsSoFar(), before);
    EXPECT_GT(before, 0);
}

TEST(PatternMotion, of_an_empty_pattern_is_empty) {
    const ShapePattern pattern = gridPattern(0, 1);
    EXPECT_TRUE(poses(PatternMotion(pattern), 1s, 0).empty());
}

}  // namespace
}  // namespace fantascope::pattern
