#include "vision/compare/shadow_comparison.h"

#include "core/check.h"

#include <Eigen/Dense>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace fantascope::vision {
namespace {

constexpr int kShadowPlaces = 2;        // samples across and down a cell
constexpr double kMostlyCounted = 0.5;  // share of the cells that count that the camera must see
// A smaller depth of the shadow, in linear light of full white, is noise and ambient light.
constexpr double kLeastDepth = 0.02;
// The least ratio of the depth to the standard deviation of the light within shadow and lit places.
// Gaussian noise alone, cut in two, has 2.7, and an even spread of values 3.5.
constexpr double kLeastRatio = 4;
constexpr double kLeastInside = 0.5;  // share of cells that are not at an edge; noise alone has hardly any
constexpr int kLevelTerms = 6;        // 1, x, y, x^2, xy, y^2
constexpr int kLookSteps = 8, kFitSteps = 5;
constexpr double kAbove = 0.9;            // weight of light above the first level; the rest is for light below it
constexpr std::size_t kFitted = 5000;     // about so many cells are fitted; more change nothing
constexpr double kRegularisation = 1e-6;  // keeps the fit solvable when a class is empty

using Terms = Eigen::Matrix<double, kLevelTerms + 1, 1>;  // of the level; then what shadow changes, which is minus the depth
using Classes = std::vector<std::uint8_t>;                // of each cell: 1 is shadow

// The smooth lit level, and how much darker shadow is where the projector's light is strongest.
struct ShadowLevels {
    Terms terms = Terms::Zero();
    double deviation = 0;  // of the light from it, within the classes

    double depth() const { return -terms[kLevelTerms]; }
};

// The value that separates two classes best (Otsu 1979).
double splitOf(const std::vector<double>& values) {
    constexpr int kBins = 256;
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    const double low = *least, width = (*most - *least) / kBins;
    if (width <= 0) return low;
    std::vector<double> count(kBins), sum(kBins);
    double total = 0;
    for (const double value : values) {
        const auto bin = static_cast<std::size_t>(std::min<double>(kBins - 1, (value - low) / width));
        count[bin] += 1, sum[bin] += value, total += value;
    }
    const auto all = static_cast<double>(values.size());
    double below = 0, sumBelow = 0, best = -1, split = low;
    for (std::size_t bin = 0; bin + 1 < count.size(); ++bin) {
        below += count[bin], sumBelow += sum[bin];
        if (below == 0 || below == all) continue;
        const double apart = sumBelow / below - (total - sumBelow) / (all - below);
        const double between = below * (all - below) * apart * apart;
        if (between > best) best = between, split = low + static_cast<double>(bin + 1) * width;
    }
    return split;
}

// About as many rows as the camera has pixels down the canvas.
glm::ivec2 gridOf(const NominalView& view) {
    const auto gridWith = [&](int rows) {
        return glm::ivec2(std::max(1, static_cast<int>(std::lround(rows * view.canvasAspect))), rows);
    };
    const CanvasPart part = view.warp.shown();
    const glm::dvec2 middle = 0.5 * (part.low + part.high), step = 0.02 * (part.high - part.low);
    const auto at = view.pixelOf(middle), right = view.pixelOf(middle + glm::dvec2(step.x, 0)),
               below = view.pixelOf(middle + glm::dvec2(0, step.y));
    if (!at || !right || !below) return gridWith(ShadowComparison::kRows);
    const double across = glm::length(*right - *at) / (step.x * view.canvasAspect), down = glm::length(*below - *at) / step.y;
    return gridWith(std::clamp(static_cast<int>(std::sqrt(across * down)), 1, ShadowComparison::kRows));
}

}  // namespace

struct ShadowComparison::Tables {
    glm::ivec2 frameSize{0};
    CameraLight light;
    glm::ivec2 grid{0};
    std::vector<CanvasCell> cells;
    std::vector<Terms> terms;  // of each cell, without shadow
    std::vector<double> gain;  // of each cell: how strongly the projector lights it; the strongest is 1
    double meanGain = 0;
    std::vector<std::vector<std::size_t>> beside;  // of each cell: its neighbours in sight
    glm::dvec3 weights{0};                         // of the channels
    bool isSeen = false;                           // the camera sees most of what counts

    double levelOf(const ShadowLevels& levels, std::size_t cell) const {
        return levels.terms.head<kLevelTerms>().dot(terms[cell].head<kLevelTerms>());
    }
    std::size_t stride() const { return std::max<std::size_t>(1, cells.size() / kFitted); }

    // The light of each cell in the channels in which shadow differs.
    std::vector<double> lightOf(const RgbaImage& frame) const {
        std::vector<double> values;
        for (const CanvasCell& cell : cells) values.push_back(glm::dot(weights, linearOf(light, frame, cell)));
        return values;
    }

    // A first guess: the darker cells.
    static Classes darkerCells(const std::vector<double>& values) {
        const double split = splitOf(values);
        Classes classes;
        for (const double value : values) classes.push_back(value < split);
        return classes;
    }

    // A first guess for light that is uneven: cells far below a smooth level that most of the
    // brighter light is at.
    Classes cellsBelowLevel(const std::vector<double>& values) const {
        ShadowLevels level;
        for (int step = 0; step < kLookSteps; ++step) {
            Eigen::Matrix<double, kLevelTerms + 1, kLevelTerms + 1> normal = decltype(normal)::Identity() * kRegularisation;
            Terms right = Terms::Zero();
            for (std::size_t i = 0; i < cells.size(); i += stride()) {
                const double weight = step == 0 || values[i] > levelOf(level, i) ? kAbove : 1 - kAbove;
                normal += weight * terms[i] * terms[i].transpose();
                right += weight * values[i] * terms[i];
            }
            level.terms = normal.ldlt().solve(right);
        }
        std::vector<double> missing;
        for (std::size_t i = 0; i < cells.size(); ++i) missing.push_back(levelOf(level, i) - values[i]);
        const double split = splitOf(missing);
        Classes classes;
        for (const double value : missing) classes.push_back(value > split);
        return classes;
    }

    // Whether all neighbours of a cell are of its class. Others may be in half-shadow, and say
    // little of the levels.
    bool isInside(const Classes& classes, std::size_t cell) const {
        return std::ranges::all_of(beside[cell], [&](std::size_t other) { return classes[other] == classes[cell]; });
    }

    // Nothing if too few cells are inside a class.
    std::optional<ShadowLevels> levelsOf(const std::vector<double>& values, const Classes& classes) const {
        std::vector<std::size_t> inside;
        for (std::size_t i = 0; i < cells.size(); i += stride())
            if (isInside(classes, i)) inside.push_back(i);
        if (static_cast<double>(inside.size() * stride()) < kLeastInside * static_cast<double>(cells.size())) return std::nullopt;
        const auto termsOf = [&](std::size_t i) {
            Terms row = terms[i];
            row[kLevelTerms] = classes[i] * gain[i];
            return row;
        };
        Eigen::Matrix<double, kLevelTerms + 1, kLevelTerms + 1> normal = decltype(normal)::Identity() * kRegularisation;
        Terms right = Terms::Zero();
        for (const std::size_t i : inside) {
            const Terms row = termsOf(i);
            normal += row * row.transpose();
            right += values[i] * row;
        }
        ShadowLevels levels{normal.ldlt().solve(right)};
        double squares = 0;
        for (const std::size_t i : inside) squares += std::pow(values[i] - levels.terms.dot(termsOf(i)), 2);
        levels.deviation = std::sqrt(squares / static_cast<double>(inside.size()));
        return levels;
    }

    // Fits levels and classes in turn. Nothing if no shadow stands out.
    std::optional<ShadowLevels> fitted(const std::vector<double>& values, Classes& classes) const {
        std::optional<ShadowLevels> levels;
        for (int step = 0; step < kFitSteps; ++step) {
            levels = levelsOf(values, classes);
            if (!levels || levels->depth() <= 0) return std::nullopt;
            for (std::size_t i = 0; i < cells.size(); ++i)
                classes[i] = values[i] < levelOf(*levels, i) - 0.5 * levels->depth() * gain[i];
        }
        if (meanGain * levels->depth() < std::max(kLeastDepth, kLeastRatio * levels->deviation)) return std::nullopt;
        return levels;
    }

    // Which cells are in shadow: by the first guess that leads to the better fit.
    std::optional<Classes> shadowIn(const std::vector<double>& values) const {
        Classes darker = darkerCells(values), below = cellsBelowLevel(values);
        const auto ofDarker = fitted(values, darker), ofBelow = fitted(values, below);
        if (!ofDarker && !ofBelow) return std::nullopt;
        return ofDarker && (!ofBelow || ofDarker->deviation < ofBelow->deviation) ? darker : below;
    }
};

ShadowComparison::ShadowComparison(const NominalView& view, glm::dvec3 difference, const GreyImage& counted) {
    const double sum = std::abs(difference.r) + std::abs(difference.g) + std::abs(difference.b);
    FANTASCOPE_CHECK(sum > 0 && !counted.empty(), "a shadow must differ from light somewhere");
    auto tables = std::make_shared<Tables>();
    tables->frameSize = view.camera.size;
    tables->light = view.light;
    tables->weights = difference / sum;
    const glm::ivec2 grid = tables->grid = gridOf(view);
    const GreyImage counts = resized(counted, grid.x, grid.y);
    const CanvasPart part = view.warp.shown();
    double all = 0;
    for (int row = 0; row < grid.y; ++row)
        for (int column = 0; column < grid.x; ++column) {
            const glm::dvec2 at = (glm::dvec2(column, row) + 0.5) / glm::dvec2(grid);
            const bool isShown = at.x > part.low.x && at.x < part.high.x && at.y > part.low.y && at.y < part.high.y;
            all += isShown && counts.at(column, row) > 0.5f;
        }
    Image<int> indices(grid.x, grid.y, -1);
    for (CanvasCell& cell : cellsInSight(view, grid, kShadowPlaces)) {
        if (counts.at(cell.column, cell.row) <= 0.5f) continue;
        const glm::dvec2 at = 2.0 * (glm::dvec2(cell.column, cell.row) + 0.5) / glm::dvec2(grid) - 1.0;
        Terms terms;
        terms << 1, at.x, at.y, at.x * at.x, at.x * at.y, at.y * at.y, 0;
        tables->terms.push_back(terms);
        tables->gain.push_back(view.isEvenedOut ? 1 : cell.gain);
        indices.at(cell.column, cell.row) = static_cast<int>(tables->cells.size());
        tables->cells.push_back(std::move(cell));
    }
    for (const double gain : tables->gain) tables->meanGain += gain / static_cast<double>(tables->gain.size());
    for (const CanvasCell& cell : tables->cells) {
        auto& beside = tables->beside.emplace_back();
        for (const glm::ivec2 way : {glm::ivec2(-1, 0), glm::ivec2(1, 0), glm::ivec2(0, -1), glm::ivec2(0, 1)}) {
            const int x = cell.column + way.x, y = cell.row + way.y;
            if (x >= 0 && y >= 0 && x < grid.x && y < grid.y && indices.at(x, y) >= 0)
                beside.push_back(static_cast<std::size_t>(indices.at(x, y)));
        }
    }
    tables->isSeen = !tables->cells.empty() && static_cast<double>(tables->cells.size()) >= kMostlyCounted * all;
    tables_ = tables;
}

std::optional<double> ShadowComparison::compare(const RgbaImage& frame, const GreyImage& wanted) const {
    const Tables& tables = *tables_;
    if (!tables.isSeen || glm::ivec2(frame.width(), frame.height()) != tables.frameSize) return std::nullopt;
    const auto shadow = tables.shadowIn(tables.lightOf(frame));
    if (!shadow) return std::nullopt;
    const GreyImage target = resized(wanted, tables.grid.x, tables.grid.y);
    std::size_t both = 0, either = 0;
    for (std::size_t i = 0; i < tables.cells.size(); ++i) {
        const bool isWanted = target.at(tables.cells[i].column, tables.cells[i].row) > 0.5f, isDark = (*shadow)[i] > 0;
        both += isWanted && isDark, either += isWanted || isDark;
    }
    return either > 0 ? std::optional(static_cast<double>(both) / static_cast<double>(either)) : std::nullopt;
}

}  // namespace fantascope::vision
