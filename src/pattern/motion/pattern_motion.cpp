#include "pattern/motion/pattern_motion.h"

#include "pattern/motion/harmonic_motion.h"
#include "pattern/shape/streams.h"

#include "core/check.h"
#include "core/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace fantascope::pattern {
namespace {

// The axes of an instance and of a group. An axis's number is part of its random stream's identity.
enum Axis : std::size_t { kX, kY, kTiltX, kTiltY, kTurn, kAxes };
enum GroupAxis : std::size_t { kMajor, kMinor, kGroupAxes };

// The movement of an instance or a group at one frame, relative to its rest. As floats,
// displacements are accurate to 1e-7 of their range.
template <std::size_t axes>
struct Key {
    std::array<float, axes> displacement;
    std::array<float, axes> slope;  // displacement per frame

    void set(std::size_t axis, MotionState state, double rate) {
        displacement[axis] = static_cast<float>(state.x);
        slope[axis] = static_cast<float>(state.y / rate);
    }
};
using GroupKey = Key<kGroupAxes>;
using InstanceKey = Key<kAxes>;

template <std::size_t axes>
std::array<double, axes> between(const Key<axes>& from, const Key<axes>& to, const std::array<double, 4>& weights) {
    std::array<double, axes> moved;
    for (std::size_t axis = 0; axis < axes; ++axis)
        moved[axis] = weights[0] * from.displacement[axis] + weights[1] * from.slope[axis] + weights[2] * to.displacement[axis] +
                      weights[3] * to.slope[axis];
    return moved;
}

// Stage 2, step 2: the movement of each group along the major direction and across it, frame by
// frame.
std::vector<GroupKey> groupKeys(const ShapePattern& pattern, int threads) {
    const MotionSettings& motion = pattern.motion;
    const HarmonicMotion major(motion.groupMajor, motion), minor(motion.groupMinor, motion);
    const std::array<const HarmonicMotion*, kGroupAxes> axes{&major, &minor};
    std::vector<GroupKey> keys(static_cast<std::size_t>(motion.frames) * pattern.groups);
    parallelFor(static_cast<int>(pattern.groups), threads, [&](int index) {
        const auto group = static_cast<std::size_t>(index);
        for (std::size_t axis = 0; axis < kGroupAxes; ++axis) {
            Rng rng(streamSeed(pattern.seed, {Stream::GroupMotion, group, axis}));
            const std::vector<MotionState> loop = axes[axis]->draw(rng);
            for (std::size_t frame = 0; frame < loop.size(); ++frame)
                keys[frame * pattern.groups + group].set(axis, loop[frame], motion.rate);
        }
    });
    return keys;
}

// Stage 2, step 3: the movement of each instance relative to its group's, frame by frame.
std::vector<InstanceKey> instanceKeys(const ShapePattern& pattern, int threads) {
    const MotionSettings& motion = pattern.motion;
    const std::size_t instances = pattern.instances.size();
    const HarmonicMotion translation(motion.localTranslation, motion), tilt(motion.localTilt, motion),
        turn(motion.localTurn, motion);
    const std::array<const HarmonicMotion*, kAxes> axes{&translation, &translation, &tilt, &tilt, &turn};
    std::vector<InstanceKey> keys(static_cast<std::size_t>(motion.frames) * instances);
    parallelFor(static_cast<int>(instances), threads, [&](int index) {
        const auto i = static_cast<std::size_t>(index);
        for (std::size_t axis = 0; axis < kAxes; ++axis) {
            Rng rng(streamSeed(pattern.seed, {Stream::InstanceMotion, pattern.instances[i].id, axis}));
            const std::vector<MotionState> loop = axes[axis]->draw(rng);
            for (std::size_t frame = 0; frame < loop.size(); ++frame)
                keys[frame * instances + i].set(axis, loop[frame], motion.rate);
        }
    });
    return keys;
}

}  // namespace

struct PatternMotion::Tables {
    struct Rest {
        InstancePose pose;
        std::uint32_t group;
    };
    Time period;
    std::size_t frames;
    glm::dvec2 direction;  // of the groups' major movement, a unit vector
    std::size_t groups;
    std::vector<Rest> rest;
    // Frame by frame, `groups` and rest.size() keys each, so that posesAt() reads two contiguous
    // runs of each.
    std::vector<GroupKey> groupKeys;
    std::vector<InstanceKey> instanceKeys;
};

PatternMotion::PatternMotion(const ShapePattern& pattern, int threads) {
    const MotionSettings& motion = pattern.motion;
    auto tables = std::make_shared<Tables>();
    tables->period = tickTime(motion.frames, motion.rate);
    tables->frames = static_cast<std::size_t>(motion.frames);
    tables->direction = {std::cos(motion.direction), std::sin(motion.direction)};
    tables->groups = pattern.groups;
    for (const ShapeInstance& instance : pattern.instances) {
        FANTASCOPE_CHECK(instance.group < pattern.groups, "an instance's group must be one of the pattern's");
        tables->rest.push_back({{instance.centre, instance.size, instance.rotation}, instance.group});
    }
    tables->groupKeys = groupKeys(pattern, threads);
    tables->instanceKeys = instanceKeys(pattern, threads);
    tables_ = std::move(tables);
}

Time PatternMotion::period() const { return tables_->period; }

void PatternMotion::posesAt(Time time, const Wind& wind, std::span<InstancePose> out) const {
    const Tables& tables = *tables_;
    const std::size_t instances = tables.rest.size();
    FANTASCOPE_CHECK(out.size() == instances, "posesAt fills one pose for every instance");
    // The phase is computed in whole nanoseconds, so that the millionth loop equals the first bit
    // for bit.
    const Time remainder = time % tables.period;
    const Time phase = remainder < Time::zero() ? remainder + tables.period : remainder;
    const double position =
        static_cast<double>(phase.count()) / static_cast<double>(tables.period.count()) * static_cast<double>(tables.frames);
    const std::size_t frame = std::min(static_cast<std::size_t>(position), tables.frames - 1);
    const std::size_t next = (frame + 1) % tables.frames;
    std::array<double, 4> weights = hermiteWeights(position - static_cast<double>(frame));
    for (double& weight : weights) weight *= wind.strength;  // the curve is linear in its states

    const glm::dvec2 along = wind.ownDirection * tables.direction + wind.direction, across(-along.y, along.x);
    const GroupKey *groupFrom = &tables.groupKeys[frame * tables.groups], *groupTo = &tables.groupKeys[next * tables.groups];
    const InstanceKey *from = tables.instanceKeys.data() + frame * instances, *to = tables.instanceKeys.data() + next * instances;
    for (std::size_t i = 0; i < instances; ++i) {
        const auto& [rest, group] = tables.rest[i];
        const auto [major, minor] = between(groupFrom[group], groupTo[group], weights);
        const auto moved = between(from[i], to[i], weights);
        out[i] = {rest.centre + major * along + minor * across + glm::dvec2(moved[kX], moved[kY]), rest.size,
                  rest.rotation + glm::dvec3(moved[kTiltX], moved[kTiltY], moved[kTurn])};
    }
}

}  // namespace fantascope::pattern
