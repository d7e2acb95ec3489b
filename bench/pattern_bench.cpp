// Measures the results of the search for a pattern, with both methods: one row per guide, method
// and time limit, with the number of evaluations. Times are CPU seconds on one thread. "redraw":
// whether the search's own z equals that of a fresh drawing. "strays": how far local movement
// displaces the shapes' vertices, in mean sizes (LoopQuality::localDisplacement).

#include "pattern/search/measure.h"
#include "pattern/search/motion_fit.h"
#include "pattern/search/pattern_search.h"
#include "pattern/shape/elemental_shape.h"

#include "core/parallel.h"
#include "core/random.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <functional>
#include <map>
#include <numbers>
#include <vector>

namespace fantascope::pattern {
namespace {

double processorSeconds() {
    timespec now{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Yardstick: counts the bits of a 1280x720 picture's words, a thousand times.
double yardstick() {
    std::vector<std::uint64_t> words(1280 * 720 / 64);
    Rng rng(1);
    for (std::uint64_t& word : words) word = std::uint64_t{rng.bits()} << 32 | rng.bits();
    const double start = processorSeconds();
    std::int64_t bits = 0;
    for (int i = 0; i < 1000; ++i)
        for (std::uint64_t& word : words) bits += std::popcount(word += bits & 1);
    const double took = processorSeconds() - start;
    return bits > 0 ? took : 0;
}

// Renders a picture of 1280x720 from a function of the point, in pixels, with 4 x 4 samples per
// pixel.
GreyImage picture(const std::function<double(glm::dvec2)>& valueAt) {
    GreyImage image(1280, 720);
    constexpr int kSamples = 4;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            double sum = 0;
            for (int i = 0; i < kSamples * kSamples; ++i)
                sum += valueAt(glm::dvec2(x, y) + (0.5 + glm::dvec2(i % kSamples, i / kSamples)) / double(kSamples));
            image.at(x, y) = static_cast<float>(sum / (kSamples * kSamples));
        }
    return image;
}

double distanceToSegment(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
    const double along = std::clamp(glm::dot(p - a, b - a) / std::max(1e-9, glm::dot(b - a, b - a)), 0.0, 1.0);
    return glm::length(p - (a + along * (b - a)));
}

struct Limb {
    glm::dvec2 from, to;
    double width, value;
};
double drawn(glm::dvec2 p, const std::vector<Limb>& limbs, double ground) {
    double value = ground;
    for (const Limb& limb : limbs)
        if (distanceToSegment(p, limb.from, limb.to) < limb.width / 2) value = limb.value;
    return value;
}

// "LUX" and a ring, in white strokes with round ends.
GreyImage lettering() {
    const std::vector<Limb> strokes = {{{140, 160}, {140, 560}, 90, 1},  {{140, 560}, {330, 560}, 90, 1},
                                       {{440, 160}, {440, 450}, 90, 1},  {{680, 160}, {680, 450}, 90, 1},
                                       {{810, 160}, {1060, 560}, 90, 1}, {{1060, 160}, {810, 560}, 90, 1}};
    return picture([&](glm::dvec2 p) {
        const bool bow = p.y > 450 && std::abs(glm::length(p - glm::dvec2(560, 450)) - 120) < 45;
        const bool ring = std::abs(glm::length(p - glm::dvec2(1170, 560)) - 50) < 18;
        return bow || ring ? 1.0 : drawn(p, strokes, 0);
    });
}

GreyImage soft() {
    const auto blob = [](glm::dvec2 p, glm::dvec2 centre, double radius) {
        return std::exp(-glm::dot(p - centre, p - centre) / (2 * radius * radius));
    };
    return picture([&](glm::dvec2 p) { return std::min(1.0, 0.95 * blob(p, {420, 330}, 130) + 0.8 * blob(p, {900, 420}, 160)); });
}

// A walking person in greys, on a patch of ground.
GreyImage figure() {
    const std::vector<Limb> limbs = {{{640, 380}, {560, 520}, 60, 0.59},  {{560, 520}, {480, 640}, 48, 0.59},
                                     {{650, 220}, {740, 330}, 44, 0.63},  {{740, 330}, {800, 300}, 36, 0.63},
                                     {{650, 220}, {640, 390}, 110, 0.86}, {{640, 390}, {730, 510}, 64, 0.9},
                                     {{730, 510}, {740, 650}, 50, 0.9},   {{640, 220}, {560, 340}, 46, 0.94},
                                     {{560, 340}, {600, 430}, 38, 0.94},  {{665, 110}, {665, 110}, 124, 0.98}};
    return blurred(picture([&](glm::dvec2 p) {
                       const glm::dvec2 ground = (p - glm::dvec2(640, 650)) / glm::dvec2(420, 40);
                       return drawn(p, limbs, glm::dot(ground, ground) < 1 ? 0.35 : 0.06);
                   }),
                   2);
}

// A pebble of 288 triangles: a dented ellipsoid.
ElementalShape pebble() {
    constexpr int kAround = 16, kRings = 9;
    TriangleMesh mesh;
    const auto point = [](double height, double angle) {
        const double across = std::sqrt(1 - height * height) * (1 + 0.15 * std::cos(3 * angle));
        return glm::vec3(across * std::cos(angle), 0.6 * across * std::sin(angle), 0.8 * height);
    };
    mesh.vertices = {point(-1, 0), point(1, 0)};
    for (int ring = 0; ring < kRings; ++ring)
        for (int i = 0; i < kAround; ++i)
            mesh.vertices.push_back(
                point(std::sin(std::numbers::pi * ((ring + 1.0) / (kRings + 1) - 0.5)), 2 * std::numbers::pi * i / kAround));
    for (std::uint32_t i = 0; i < kAround; ++i) {
        const std::uint32_t next = (i + 1) % kAround;
        mesh.triangles.emplace_back(0, 2 + next, 2 + i);
        mesh.triangles.emplace_back(1, 2 + (kRings - 1) * kAround + i, 2 + (kRings - 1) * kAround + next);
        for (std::uint32_t ring = 0; ring + 1 < kRings; ++ring) {
            const std::uint32_t a = 2 + ring * kAround + i, b = 2 + ring * kAround + next;
            mesh.triangles.emplace_back(a, b, a + kAround);
            mesh.triangles.emplace_back(b, b + kAround, a + kAround);
        }
    }
    return makeShape("pebble", mesh).value();
}

constexpr int kLoopMoments = 200;

using Method = PatternSearch::Method;

struct Task {
    std::string name;
    GreyImage guide;
    std::string shape;                   // a built-in shape, or "pebble"
    std::vector<double> refined, paper;  // seconds
    bool isBlackAndWhite;                // then z says how well the pattern reads
};

struct Options {
    std::vector<std::string> only;
    std::vector<double> seconds;
    std::optional<std::filesystem::path> images;
    std::uint64_t seed = 1;
    bool refinedAlone = false;
};

ShapePattern blank(const Task& task, std::uint64_t seed) {
    ShapePattern pattern;
    pattern.seed = seed;
    pattern.shapes = {task.shape == "pebble" ? pebble() : loadShape(task.shape).value()};
    return pattern;
}

PatternSearch::Found search(const Task& task, Method method, double limit, std::uint64_t seed, double targetZ = 0) {
    PatternSearch::Options options;
    options.method = method;
    options.targetZ = targetZ;
    const double start = processorSeconds();
    const auto askStop = [&](const PatternSearch::Progress&) -> std::optional<PatternSearch::StopReason> {
        if (method == Method::Paper && processorSeconds() - start >= limit) return PatternSearch::StopReason::Time;
        return std::nullopt;
    };
    std::optional<double> running;
    const auto plan = [&](const PatternSearch::Progress& now) -> std::optional<int> {
        if (!running) running = processorSeconds();
        return PatternSearch::iterationsWithin(limit - (*running - start), now.iterations, processorSeconds() - *running);
    };
    return PatternSearch::run(task.guide, blank(task, seed), options, 1, askStop, plan);
}

// Prints the quality of a search's result, at rest and over the loop with fitted movement; returns
// its z.
double row(const Task& task, Method method, double limit, const Options& options) {
    const double start = processorSeconds();
    PatternSearch::Found found = search(task, method, limit, options.seed);
    const double took = processorSeconds() - start;
    const PatternQuality quality = measure(found.pattern, task.guide);
    found.pattern.motion = fittedMotion(found.pattern, task.guide, hardwareThreads());
    const LoopQuality loop = LoopMeasure(found.pattern, task.guide, hardwareThreads()).in({}, kLoopMoments);
    fmt::print(
        "{:<18} {:<8} {:>6.2f} {:>8.4f} {:>8.4f} {:>7.4f} {:>7.3f} {:>9} {:>11} {:>10.0f} {:>6} {:>8.4f} {:>9.4f} {:>7.3f}\n",
        task.name, name(method), took, quality.z, quality.zBound, quality.tone, quality.overlap, found.pattern.instances.size(),
        found.summary.evaluations, static_cast<double>(found.summary.evaluations) / took,
        found.summary.z == quality.z ? "same" : "OTHER", loop.z, loop.tone, loop.localDisplacement);
    std::fflush(stdout);
    if (options.images) {
        std::filesystem::create_directories(*options.images);
        const auto file = *options.images / fmt::format("{}-{}-{:g}.png", task.name, name(method), limit);
        if (const auto written = writePng(file, drawWhiteOnBlack(found.pattern, task.guide.width(), task.guide.height()));
            !written)
            fmt::print(stderr, "{}\n", written.error().message());
    }
    return quality.z;
}

// Prints how much sooner the refined method reaches the paper's method's final z.
void compare(const Task& task, double paperZ, double limit, const Options& options) {
    const double start = processorSeconds();
    const PatternSearch::Found found = search(task, Method::Refined, task.refined.front(), options.seed, paperZ);
    const double took = processorSeconds() - start;
    if (found.summary.reason == PatternSearch::StopReason::TargetReached)
        fmt::print("{}: reaches the paper's method's z after {:g} s ({:.4f}) within {:.3f} s, {:.0f} times sooner\n", task.name,
                   limit, paperZ, took, limit / took);
    else
        fmt::print("{}: does not reach the paper's method's z after {:g} s ({:.4f})\n", task.name, limit, paperZ);
}

int run(const Options& options) {
    fmt::print("yardstick: {:.3f} s to count the bits of 1000 pictures\n\n", yardstick());
    fmt::print("{:<18} {:<8} {:>6} {:>8} {:>8} {:>7} {:>7} {:>9} {:>11} {:>10} {:>6} {:>8} {:>9} {:>7}\n", "guide", "method",
               "CPU s", "z", "z bound", "tone", "overlap", "instances", "evaluations", "a second", "redraw", "loop z",
               "loop tone", "strays");
    const std::vector<Task> tasks = {{"lettering", lettering(), "triangle", {1, 5}, {1, 5, 60}, true},
                                     {"lettering-pebbles", lettering(), "pebble", {5}, {5}, true},
                                     {"soft", soft(), "triangle", {5, 30}, {5, 30}, false},
                                     {"figure", figure(), "triangle", {5, 30}, {5, 30}, false}};
    for (const Task& task : tasks) {
        if (!options.only.empty() && std::find(options.only.begin(), options.only.end(), task.name) == options.only.end())
            continue;
        for (const Method method : {Method::Refined, Method::Paper}) {
            if (options.refinedAlone && method == Method::Paper) continue;
            double z = 1, last = 0;
            for (const double seconds : !options.seconds.empty()    ? options.seconds
                                        : method == Method::Refined ? task.refined
                                                                    : task.paper)
                z = row(task, method, last = seconds, options);
            if (method == Method::Paper && task.isBlackAndWhite) compare(task, z, last, options);
        }
    }
    return 0;
}

}  // namespace
}  // namespace fantascope::pattern

int main(int argc, char** argv) {
    CLI::App program("Measures the results of the search for a pattern");
    fantascope::pattern::Options options;
    program.add_option("--only", options.only, "Only these guides")->delimiter(',');
    program.add_option("--seconds", options.seconds, "Time limits instead of the table's")->delimiter(',');
    program.add_option("--images", options.images, "A folder to write the results' pictures to");
    program.add_option("--seed", options.seed, "Random seed of every search");
    program.add_flag("--refined", options.refinedAlone, "Only the refined method");
    CLI11_PARSE(program, argc, argv);
    return fantascope::pattern::run(options);
}
