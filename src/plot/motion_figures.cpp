#include "pattern/motion/harmonic_motion.h"
#include "pattern/motion/pattern_motion.h"
#include "pattern/shape/streams.h"

#include "plot/chart.h"
#include "plot/figures.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>

namespace fantascope::plot {
namespace {

constexpr std::array<glm::dvec3, 3> kColours{{{0.12, 0.35, 0.8}, {0.9, 0.45, 0.05}, {0.1, 0.55, 0.25}}};

// The indices of a few instances, of different groups if possible.
std::vector<std::size_t> aFewOf(const pattern::ShapePattern& pattern) {
    std::vector<std::size_t> few;
    std::vector<std::uint32_t> groups;
    for (std::size_t i = 0; i < pattern.instances.size() && few.size() < kColours.size(); ++i) {
        if (std::find(groups.begin(), groups.end(), pattern.instances[i].group) != groups.end()) continue;
        groups.push_back(pattern.instances[i].group);
        few.push_back(i);
    }
    return few;
}

using Poses = std::vector<pattern::InstancePose>;

// One row of Figure 6: a value of a few instances over time.
struct Row {
    std::string title, label;
    // The value of an instance, from all poses in the default wind and from those with groups at
    // rest.
    std::function<double(std::size_t instance, const Poses& all, const Poses& local)> value;
};

}  // namespace

std::vector<double> powerSpectrum(std::span<const double> samples) {
    const std::size_t count = samples.size();
    std::vector<std::complex<double>> turns(count);
    for (std::size_t i = 0; i < count; ++i)
        turns[i] = std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count));
    std::vector<double> power;
    for (std::size_t bin = 0; bin <= count / 2; ++bin) {
        std::complex<double> sum = 0;
        for (std::size_t i = 0; i < count; ++i) sum += samples[i] * turns[bin * i % count];
        power.push_back(std::norm(sum));
    }
    return power;
}

Page trajectoriesFigure(const pattern::ShapePattern& pattern) {
    constexpr double kSeconds = 20, kStep = 1.0 / 60;
    const std::vector<std::size_t> few = aFewOf(pattern);
    // Their movement does not depend on other instances.
    pattern::ShapePattern shown = pattern;
    shown.instances.clear();
    for (const std::size_t index : few) shown.instances.push_back(pattern.instances[index]);
    const pattern::PatternMotion motion(shown, 1);
    const double direction = pattern.motion.direction, size = pattern.meanSize();
    const glm::dvec2 along(std::cos(direction), std::sin(direction));
    const double seconds = std::min(kSeconds, fantascope::seconds(motion.period()));

    const auto shift = [&](std::size_t i, const Poses& poses) {
        return glm::dot(poses[i].centre - shown.instances[i].centre, along) / size;
    };
    const std::array<Row, 4> rows{{
        {"(a) group, along its major direction", "mean sizes",
         [&](std::size_t i, const Poses& all, const Poses& local) { return shift(i, all) - shift(i, local); }},
        {"(b) local movement in the same direction", "mean sizes",
         [&](std::size_t i, const Poses&, const Poses& local) { return shift(i, local); }},
        {"(c) both together", "mean sizes", [&](std::size_t i, const Poses& all, const Poses&) { return shift(i, all); }},
        {"(d) turn about z", "degrees",
         [&](std::size_t i, const Poses& all, const Poses&) {
             return (all[i].rotation.z - shown.instances[i].rotation.z) * 180 / std::numbers::pi;
         }},
    }};
    std::array<std::vector<std::vector<glm::dvec2>>, rows.size()> paths;
    std::array<std::vector<double>, rows.size()> values;
    for (auto& path : paths) path.resize(few.size());
    Poses all(few.size()), local(few.size());
    for (double time = 0; time <= seconds; time += kStep) {
        motion.posesAt(fromSeconds(time), {}, all);
        motion.posesAt(fromSeconds(time), {.ownDirection = 0}, local);
        for (std::size_t row = 0; row < rows.size(); ++row)
            for (std::size_t i = 0; i < few.size(); ++i) {
                values[row].push_back(rows[row].value(i, all, local));
                paths[row][i].push_back({time, values[row].back()});
            }
    }

    Page page(1100, 960);
    for (std::size_t row = 0; row < rows.size(); ++row) {
        const double top = 40 + 230 * static_cast<double>(row);
        Chart chart(page, {80, top}, {1070, top + 165}, {0, seconds, row + 1 == rows.size() ? "time, s" : ""},
                    axisAround(values[row], rows[row].label));
        chart.title(rows[row].title);
        for (std::size_t i = 0; i < few.size(); ++i) chart.line(paths[row][i], {kColours[i], 1.5});
        for (std::size_t i = 0; row == 0 && i < few.size(); ++i)
            chart.legend(fmt::format("instance {}, group {}", shown.instances[i].id, shown.instances[i].group), {kColours[i]});
    }
    return page;
}

Page spectrumFigure(const pattern::ShapePattern& pattern) {
    struct Panel {
        std::string title;
        const pattern::AxisMotion& axis;
        std::uint64_t seed;
    };
    const pattern::MotionSettings& motion = pattern.motion;
    const std::uint64_t id = pattern.instances.empty() ? 0 : pattern.instances[0].id;
    const std::uint64_t group = pattern.instances.empty() ? 0 : pattern.instances[0].group;
    // Movement depends on the seed and on the number of group or instance. Patterns that share
    // these and the settings move alike, so the figure names them.
    const std::array<Panel, 2> panels{
        {{fmt::format("seed {}, group {}, major direction", pattern.seed, group), motion.groupMajor,
          streamSeed(pattern.seed, {pattern::Stream::GroupMotion, group, 0})},
         {fmt::format("seed {}, instance {}, local translation", pattern.seed, id), motion.localTranslation,
          streamSeed(pattern.seed, {pattern::Stream::InstanceMotion, id, 0})}}};
    constexpr Stroke kForce{kColours[0], 1}, kMovement{kColours[1], 1.4}, kModel{{0, 0, 0}, 1.4, 1, true},
        kNatural{{0.5, 0.5, 0.5}, 1, 1, true};

    Page page(1240, 560);
    for (std::size_t i = 0; i < panels.size(); ++i) {
        const auto& [title, axis, seed] = panels[i];
        Rng forceRng(seed), movementRng(seed);
        const std::vector<double> force =
            pattern::Excitation(axis.beta, motion.frames, motion.rate, motion.deviation).draw(forceRng);
        pattern::AxisMotion unit = axis;
        unit.magnitude = 1, unit.range = 1e9;
        std::vector<double> movement;
        for (const pattern::MotionState& state : pattern::HarmonicMotion(unit, motion).draw(movementRng))
            movement.push_back(state.x);

        // Relative to the excitation's first bin, where the model is 1.
        const std::vector<double> forcePower = powerSpectrum(force), movementPower = powerSpectrum(movement);
        const double step = motion.rate / motion.frames, last = motion.rate / 2;
        double mean = 0;  // of the first bins relative to the model
        for (int bin = 1; bin <= 10; ++bin) mean += forcePower[bin] * std::pow(bin, 2 * axis.beta) / 10;
        std::vector<glm::dvec2> forcePoints, movementPoints, model;
        for (std::size_t bin = 1; bin < forcePower.size(); ++bin) {
            const double frequency = step * static_cast<double>(bin);
            forcePoints.push_back({frequency, forcePower[bin] / mean});
            movementPoints.push_back({frequency, movementPower[bin] / mean});
            model.push_back({frequency, std::pow(static_cast<double>(bin), -2 * axis.beta)});
        }
        const double left = 80 + 610 * static_cast<double>(i);
        const double decades = std::ceil(2 * axis.beta * std::log10(last / step)) + 2;
        Chart chart(page, {left, 50}, {left + 520, 490}, {step, last, "frequency, Hz", true},
                    {std::pow(10, -decades), 30, "power, relative to the first bin's", true});
        chart.title(fmt::format("{}: beta {:g}", title, axis.beta));
        chart.line(movementPoints, kMovement);
        chart.line(forcePoints, kForce);
        chart.line(model, kModel);
        chart.line(std::vector<glm::dvec2>{{axis.naturalFrequency, 1e-30}, {axis.naturalFrequency, 30}}, kNatural);
        chart.legend("excitation", kForce);
        chart.legend("movement", kMovement);
        chart.legend(fmt::format("slope -2 beta = {:g}", -2 * axis.beta), kModel);
        chart.legend(fmt::format("natural frequency, {:g} Hz", axis.naturalFrequency), kNatural);
    }
    return page;
}

}  // namespace fantascope::plot
