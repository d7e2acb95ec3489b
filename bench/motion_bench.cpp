// Measures the cost of a pattern's movement: grouping once when it is made, construction once when
// it is loaded, posesAt() once per frame. Yardsticks show the machine's speed.

#include "pattern/motion/pattern_motion.h"
#include "pattern/shape/grouping.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <numeric>

namespace fantascope::pattern {
namespace {

ShapePattern scattered(std::int64_t instances) {
    ShapePattern pattern;
    pattern.seed = 1;
    Rng rng(2);
    for (std::int64_t i = 0; i < instances; ++i) {
        ShapeInstance instance;
        instance.id = static_cast<std::uint32_t>(i);
        instance.centre = {rng.uniform(0, 16.0 / 9), rng.uniform()};
        instance.size = 0.02;
        pattern.instances.push_back(instance);
    }
    pattern.groups = groupCount(pattern.instances.size(), pattern.motion.instancesPerGroup);
    for (ShapeInstance& instance : pattern.instances) instance.group = instance.id % pattern.groups;
    return pattern;
}

void perInstance(benchmark::State& state) {
    state.counters["s_per_instance"] = benchmark::Counter(static_cast<double>(state.iterations() * state.range(0)),
                                                          benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void construct(benchmark::State& state) {
    const ShapePattern pattern = scattered(state.range(0));
    for (auto _ : state) benchmark::DoNotOptimize(PatternMotion(pattern, 1).period());
    perInstance(state);
}
BENCHMARK(construct)->Arg(50)->Arg(350)->Unit(benchmark::kMillisecond);

// Steps of 60 Hz, as for a projector, in a turning wind.
void posesAt(benchmark::State& state) {
    const ShapePattern pattern = scattered(state.range(0));
    const PatternMotion motion(pattern);
    std::vector<InstancePose> poses(pattern.instances.size());
    constexpr Wind kWind{.strength = 1.5, .ownDirection = 0.5, .direction = {0.3, 0.4}};
    std::int64_t refresh = 0;
    for (auto _ : state) {
        motion.posesAt(tickTime(refresh++, 60), kWind, poses);
        benchmark::DoNotOptimize(poses.data());
    }
    perInstance(state);
}
BENCHMARK(posesAt)->Arg(350)->Arg(3000)->Unit(benchmark::kMicrosecond);

void group(benchmark::State& state) {
    ShapePattern pattern = scattered(state.range(0));
    std::size_t iterations = 0;
    for (auto _ : state) iterations = assignGroups(pattern).objective.size();
    state.counters["iterations"] = static_cast<double>(iterations);
}
BENCHMARK(group)->Arg(350)->Arg(3000)->Unit(benchmark::kMillisecond);

// Yardstick: writes as many bytes as posesAt() and computes nothing.
void yardstickCopyOfPoses(benchmark::State& state) {
    const std::vector<InstancePose> from(static_cast<std::size_t>(state.range(0)));
    std::vector<InstancePose> to(from.size());
    for (auto _ : state) {
        std::copy(from.begin(), from.end(), to.begin());
        benchmark::DoNotOptimize(to.data());
    }
    perInstance(state);
}
BENCHMARK(yardstickCopyOfPoses)->Arg(350)->Arg(3000)->Unit(benchmark::kMicrosecond);

// Yardstick: the cheapest possible movement, one sine per axis.
void yardstickFiveSines(benchmark::State& state) {
    std::vector<double> moved(static_cast<std::size_t>(state.range(0)) * 5);
    double time = 0;
    for (auto _ : state) {
        time += 1.0 / 60;
        for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = std::sin(time + static_cast<double>(i));
        benchmark::DoNotOptimize(moved.data());
    }
    perInstance(state);
}
BENCHMARK(yardstickFiveSines)->Arg(350)->Arg(3000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace fantascope::pattern
