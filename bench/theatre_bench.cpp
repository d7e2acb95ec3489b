// What a generation of the search costs besides evaluating it, with yardsticks of the machine beside it; and what the skin of an actor costs.

#include "theatre/cma_es.h"
#include "theatre/mesh_shadow.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

namespace fantascope::theatre {
namespace {

constexpr int kPopulation = 40;

// blocks x size coordinates.
void generation(benchmark::State& state) {
    const auto blocks = static_cast<std::size_t>(state.range(0)), size = static_cast<std::size_t>(state.range(1));
    const std::size_t n = blocks * size;
    const CmaEs::Options options{.populationSize = kPopulation, .blocks = std::vector<int>(blocks, static_cast<int>(size))};
    CmaEs search(std::vector<double>(n, 3.0), options);
    Rng rng(1);
    std::vector<double> values(kPopulation);
    for (auto _ : state) {
        const std::span<const double> candidates = search.ask(rng);
        for (std::size_t k = 0; k < values.size(); ++k) values[k] = candidates[k * n];
        search.tell(values);
    }
}
BENCHMARK(generation)
    ->ArgNames({"blocks", "size"})
    ->ArgsProduct({{1, 3, 6}, {45}})
    ->ArgsProduct({{1}, {135, 270}})
    ->Unit(benchmark::kMicrosecond);

// Yardstick: the normal variables of a generation.
void yardstickNormals(benchmark::State& state) {
    Rng rng(1);
    std::vector<double> normals(static_cast<std::size_t>(state.range(0) * kPopulation));
    for (auto _ : state) {
        for (double& normal : normals) normal = rng.normal();
        benchmark::DoNotOptimize(normals.data());
    }
}
BENCHMARK(yardstickNormals)->Arg(45)->Arg(135)->Arg(270)->Unit(benchmark::kMicrosecond);

// Yardstick: a plain product of a size x size matrix and the population; a generation has about one and a half of them a block.
void yardstickProduct(benchmark::State& state) {
    const auto size = static_cast<std::size_t>(state.range(0));
    std::vector<double> matrix(size * size, 0.5), population(size * kPopulation, 0.25), product(size * kPopulation);
    for (auto _ : state) {
        for (std::size_t k = 0; k < kPopulation; ++k) {
            double* const column = &product[k * size];
            std::fill_n(column, size, 0.0);
            for (std::size_t j = 0; j < size; ++j)
                for (std::size_t i = 0; i < size; ++i) column[i] += matrix[j * size + i] * population[k * size + j];
        }
        benchmark::DoNotOptimize(product.data());
    }
}
BENCHMARK(yardstickProduct)->Arg(45)->Arg(135)->Arg(270)->Unit(benchmark::kMicrosecond);

// An actor of 1.75 m, 2 m before the screen, in the frame of a search: 256 rows.
void skinAndShadow(benchmark::State& state) {
    const Body body = humanBody(1.75);
    const BodyMesh mesh = humanMesh(body);
    const bool withShadow = state.range(0) != 0;
    const ScreenFrame frame({{0, 0, 7}}, -1.5, 2.5, 2.5 / 256, 307, 256);
    PosedBody posed;
    posed.pose(body, body.restPose({0, 1, 2}, {1, 0, 0, 0}));
    std::vector<glm::vec3> skin;
    MeshShadow shadow;
    BitMask mask(307, 256);
    for (auto _ : state) {
        mesh.skin(body, posed, skin);
        if (withShadow) mask.clear(), shadow.add(frame, mesh, skin, mask);
        benchmark::DoNotOptimize(skin.data());
    }
}
BENCHMARK(skinAndShadow)->ArgName("shadow")->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace fantascope::theatre
