#include "pattern/pattern_motion.h"

#include "pattern/harmonic_motion.h"
#include "pattern/streams.h"

#include "core/check.h"
#include "core/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace fantascope::pattern {
namespace {

// The axes of an instance; the number is part of its random stream's identity. A group has the first two, as major and minor.
enum Axis : std::size_t { kX, kY, kTiltX, kTiltY, kTurn, kAxes };

// The movement of one instance at one frame, relative to its rest. Floats keep a movement to 1e-7 of its range.
struct Key {
    std::array<float, kAxes> displacement;
    std::array<float, kAxes> slope;  // displacement a frame
};

using Trajectory = std::vector<MotionState>;

// Step 2: the movement of each group along the canvas's two axes.
std::vector<std::array<Trajectory, 2>> groupTrajectories(const ShapePattern& pattern, int threads) {
    const HarmonicMotion major(pattern.motion.groupMajor, pattern.motion), minor(pattern.motion.groupMinor, pattern.motion);
    const double cosine = std::cos(pattern.motion.direction), sine = std::sin(pattern.motion.direction);
    std::vector<std::array<Trajectory, 2>> groups(pattern.groups);
    parallelFor(static_cast<int>(pattern.groups), threads, [&](int index) {
        const auto group = static_cast<std::size_t>(index);
        Rng majorRng(streamSeed(pattern.seed, {Stream::GroupMotion, group, kX}));
        Rng minorRng(streamSeed(pattern.seed, {Stream::GroupMotion, group, kY}));
        auto& [x, y] = groups[group] = {major.draw(majorRng), minor.draw(minorRng)};
        for (std::size_t frame = 0; frame < x.size(); ++frame) {
            const MotionState along = x[frame], across = y[frame];
            x[frame] = cosine * along - sine * across;
            y[frame] = sine * along + cosine * across;
        }
    });
    return groups;
}

}  // namespace

struct PatternMotion::Tables {
    Time period;
    std::size_t frames;
    std::vector<InstancePose> rest;
    std::vector<Key> keys;  // frame by frame, instances.size() each: a call reads two runs of neighbours
};

PatternMotion::PatternMotion(const ShapePattern& pattern, int threads) {
    const MotionSettings& motion = pattern.motion;
    const std::size_t instances = pattern.instances.size();
    auto tables = std::make_shared<Tables>();
    tables->period = tickTime(motion.frames, motion.rate);
    tables->frames = static_cast<std::size_t>(motion.frames);
    for (const ShapeInstance& instance : pattern.instances)
        tables->rest.push_back({instance.centre, instance.size, instance.rotation});
    tables->keys.resize(tables->frames * instances);

    const auto groups = groupTrajectories(pattern, threads);
    // Step 3: the movement of each instance on top of its group's. Both are Hermite curves over the same frames, so the sum of
    // their states is the state of their sum.
    const HarmonicMotion translation(motion.localTranslation, motion), tilt(motion.localTilt, motion),
        turn(motion.localTurn, motion);
    const std::array<const HarmonicMotion*, kAxes> local{&translation, &translation, &tilt, &tilt, &turn};
    parallelFor(static_cast<int>(instances), threads, [&](int index) {
        const auto i = static_cast<std::size_t>(index);
        const ShapeInstance& instance = pattern.instances[i];
        FANTASCOPE_CHECK(instance.group < pattern.groups, "an instance's group must be one of the pattern's");
        for (std::size_t axis = 0; axis < kAxes; ++axis) {
            Rng rng(streamSeed(pattern.seed, {Stream::InstanceMotion, instance.id, axis}));
            const Trajectory own = local[axis]->draw(rng);
            for (std::size_t frame = 0; frame < own.size(); ++frame) {
                MotionState state = own[frame];
                if (axis == kX || axis == kY) state += groups[instance.group][axis][frame];
                Key& key = tables->keys[frame * instances + i];
                key.displacement[axis] = static_cast<float>(state.x);
                key.slope[axis] = static_cast<float>(state.y / motion.rate);
            }
        }
    });
    tables_ = std::move(tables);
}

Time PatternMotion::period() const { return tables_->period; }

void PatternMotion::posesAt(Time time, std::span<InstancePose> out) const {
    const auto& [period, frames, rest, keys] = *tables_;
    FANTASCOPE_CHECK(out.size() == rest.size(), "posesAt fills one pose for every instance");
    // The phase is taken in whole nanoseconds, so that the millionth loop is the first one, bit for bit.
    const Time remainder = time % period;
    const Time phase = remainder < Time::zero() ? remainder + period : remainder;
    const double position =
        static_cast<double>(phase.count()) / static_cast<double>(period.count()) * static_cast<double>(frames);
    const std::size_t frame = std::min(static_cast<std::size_t>(position), frames - 1);
    const std::array<double, 4> weights = hermiteWeights(position - static_cast<double>(frame));

    const std::span<const Key> from = std::span(keys).subspan(frame * rest.size(), rest.size());
    const std::span<const Key> to = std::span(keys).subspan((frame + 1) % frames * rest.size(), rest.size());
    for (std::size_t i = 0; i < rest.size(); ++i) {
        std::array<double, kAxes> moved;
        for (std::size_t axis = 0; axis < kAxes; ++axis)
            moved[axis] = weights[0] * from[i].displacement[axis] + weights[1] * from[i].slope[axis] +
                          weights[2] * to[i].displacement[axis] + weights[3] * to[i].slope[axis];
        out[i] = {rest[i].centre + glm::dvec2(moved[kX], moved[kY]), rest[i].size,
                  rest[i].rotation + glm::dvec3(moved[kTiltX], moved[kTiltY], moved[kTurn])};
    }
}

}  // namespace fantascope::pattern
