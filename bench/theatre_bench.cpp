// Measures the parts of a search for poses: a generation of CMA-ES, the skin of an actor,
// evaluations of the energy. Yardsticks show the machine's speed.

#include "theatre/energy/scene_energy.h"
#include "theatre/search/cma_es.h"
#include "theatre/stage/mesh_shadow.h"

#include "tests/theatre/a_scene.h"

#include <Eigen/Core>
#include <benchmark/benchmark.h>

#include <vector>

namespace fantascope::theatre {
namespace {

constexpr int kPopulation = 40;

// One generation of CMA-ES with blocks x size coordinates.
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

// Yardstick: draws the normal random numbers of a generation.
void yardstickNormals(benchmark::State& state) {
    Rng rng(1);
    std::vector<double> normals(static_cast<std::size_t>(state.range(0) * kPopulation));
    for (auto _ : state) {
        for (double& normal : normals) normal = rng.normal();
        benchmark::DoNotOptimize(normals.data());
    }
}
BENCHMARK(yardstickNormals)->Arg(45)->Arg(135)->Arg(270)->Unit(benchmark::kMicrosecond);

// Yardstick: Eigen's product of a size x size matrix and the population. A generation has about 1.5
// of them per block. A loop of our own would not do: it took 1.9 times as long where the linker had
// put it elsewhere.
void yardstickProduct(benchmark::State& state) {
    const Eigen::MatrixXd matrix = Eigen::MatrixXd::Constant(state.range(0), state.range(0), 0.5);
    const Eigen::MatrixXd population = Eigen::MatrixXd::Constant(state.range(0), kPopulation, 0.25);
    Eigen::MatrixXd product(state.range(0), kPopulation);
    for (auto _ : state) {
        product.noalias() = matrix * population;
        benchmark::DoNotOptimize(product.data());
    }
}
BENCHMARK(yardstickProduct)->Arg(45)->Arg(135)->Arg(270)->Unit(benchmark::kMicrosecond);

// An actor of 1.75 m, 2 m in front of the screen, in a search's frame of 256 rows.
void skinAndShadow(benchmark::State& state) {
    const Body body = humanBody(1.75);
    const BodyMesh mesh = humanMesh(body);
    const bool withShadow = state.range(0) != 0;
    const ScreenFrame frame(Stage{}, -1.5, 2.5, 2.5 / 256, 307, 256);
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

// One evaluation of the energy after one of three actors has moved, as in a local search; with and
// without skins.
void evaluation(benchmark::State& state) {
    PoseProblem problem = aScene({1.75, 1.75, 1.75});
    if (state.range(0) != 0) problem.buildSkins(), problem = simpler(std::move(problem));
    const std::vector<double> start = aRow(problem, {-0.8, 0, 0.8}, 2);
    makeTarget(problem, start);
    Rng rng(1);
    std::vector<std::vector<double>> poses;
    for (int i = 0; i < 64; ++i) {
        poses.push_back(nudged(problem, start, rng, 0.15));
        for (std::size_t actor = 0; actor < 3; ++actor) poses.back()[problem.firstDof(actor) + 1] = start[1];
    }
    SceneEnergy energy(problem);
    energy.pose(start, static_cast<double>(state.range(1)) / 100);
    std::size_t turn = 0;
    double sum = 0;
    for (auto _ : state) {
        const std::size_t actor = turn % 3, first = problem.firstDof(actor);
        energy.pose(actor, std::span(poses[turn++ % poses.size()]).subspan(first, problem.actors[actor].dofs));
        sum += energy.energy();
    }
    benchmark::DoNotOptimize(sum);
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(evaluation)->ArgNames({"skins", "stiffness_percent"})->ArgsProduct({{0, 1}, {1, 100}})->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace fantascope::theatre
