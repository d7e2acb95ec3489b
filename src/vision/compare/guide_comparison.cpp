#include "vision/compare/guide_comparison.h"

#include "core/check.h"

#include <Eigen/Dense>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace fantascope::vision {
namespace {

// Sigma of the low-pass, in canvas heights; the same as of the pattern's own `tone`. On the default
// site with a pattern of 400 shapes, the scores in place / with the projector turned by half a
// degree were .060 / .108 at 1/144, .043 / .092 at 1/72, .027 / .074 at 1/36 and .014 / .048 at
// 1/18: less blur counts the gaps between shapes as faults, more blur hides small moves.
constexpr double kBlur = 1.0 / 36;
constexpr int kRows = 72;                 // cells down the canvas: two per sigma
constexpr int kPlaces = 3;                // samples across and down a cell
constexpr double kMostlySeen = 0.5;       // share of the shown canvas that the camera must see
constexpr double kOutliers = 0.02;        // share of the darkest and of the brightest cells that the scale ignores
constexpr float kFlat = 0.02f;            // a smaller range, in linear light of full white, is noise and ambient light
constexpr int kBackgroundTerms = 6;       // 1, x, y, x^2, xy, y^2
constexpr double kBackgroundCost = 1e-3;  // just enough to assign ambiguous light to the picture

// wanted = scale * seen + lift, estimated from quantiles.
struct Exposure {
    double scale = 0, lift = 0;
    double span = 0;  // of the seen values
};

// Exposure, fades and the colour of the shapes scale the seen light, and uniform light lifts it.
// Both are estimated from the values alone, regardless of their places: a line through the
// quantiles of one against those of the other. So a picture in the wrong place is not mistaken for
// a faint one in the right place, as a cell-by-cell fit would do.
Exposure exposureOf(std::vector<float> seen, std::vector<float> wanted) {
    std::sort(seen.begin(), seen.end());
    std::sort(wanted.begin(), wanted.end());
    const auto first = static_cast<std::size_t>(kOutliers * static_cast<double>(seen.size())), last = seen.size() - first;
    const auto count = static_cast<double>(last - first);
    double meanSeen = 0, meanWanted = 0, variance = 0, covariance = 0;
    for (std::size_t i = first; i < last; ++i) {
        meanSeen += seen[i] / count;
        meanWanted += wanted[i] / count;
    }
    for (std::size_t i = first; i < last; ++i) {
        variance += (seen[i] - meanSeen) * (seen[i] - meanSeen);
        covariance += (seen[i] - meanSeen) * (wanted[i] - meanWanted);
    }
    const double scale = variance > 0 ? covariance / variance : 0;
    return {scale, meanWanted - scale * meanSeen, seen[last - 1] - seen[first]};
}

}  // namespace

// The same without a lift, from the mean values: whatever is brighter or darker than its part of
// the picture's light shows, even in a picture that is nearly the same everywhere.
double constantOf(const std::vector<float>& seen, const std::vector<float>& wanted) {
    double sumSeen = 0, sumWanted = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) sumSeen += seen[i], sumWanted += wanted[i];
    return sumSeen > 0 ? sumWanted / sumSeen : 0;
}

// What is wanted of the cells in sight, and how it is found in what is seen.
struct Measure {
    std::vector<float> gain;       // how strongly a cell is lit that is wanted white
    std::vector<float> wanted;     // low-passed
    Eigen::MatrixXf background;    // cells x terms
    Eigen::MatrixXf backgroundOf;  // terms x cells: how much of each term is in the low-passed light
};

// Linear light of every cell, by channel.
using CellLight = std::array<std::vector<float>, 3>;

// How what is seen compares with what is wanted: 1 is white.
struct Comparison {
    Exposure exposure;
    std::vector<double> difference;  // of every cell: seen - wanted
};

struct GuideComparison::Tables {
    glm::ivec2 frameSize;
    CameraLight light;
    glm::ivec2 grid;   // cells across and down the canvas
    double shown = 1;  // the share of the canvas that the output shows
    std::vector<CanvasCell> cells;
    GreyImage weights;  // sum of the low-pass over the cells in sight
    Measure z, tone;

    // A Gaussian over the cells in sight, as if there were no others.
    std::vector<float> lowPassed(const std::vector<float>& values) const {
        GreyImage canvas(grid.x, grid.y);
        for (std::size_t i = 0; i < cells.size(); ++i) canvas.at(cells[i].column, cells[i].row) = values[i];
        canvas = blurred(canvas, kBlur * kRows);
        std::vector<float> result;
        for (const CanvasCell& cell : cells)
            result.push_back(canvas.at(cell.column, cell.row) / weights.at(cell.column, cell.row));
        return result;
    }

    // `fallsOff`: cells that the projector lights less are to be darker.
    Measure measureOf(const GreyImage& wanted, bool fallsOff) const {
        const GreyImage guide = resized(wanted, grid.x, grid.y);
        Measure measure;
        std::vector<float> values;
        for (const CanvasCell& cell : cells) {
            values.push_back(guide.at(cell.column, cell.row));
            measure.gain.push_back(fallsOff ? static_cast<float>(cell.gain) : 1);
        }
        measure.wanted = lowPassed(values);
        // Least squares of the low-passed light on the low-passed guide and a smooth background:
        // the first column keeps the picture out of the background.
        const auto count = static_cast<int>(cells.size());
        Eigen::MatrixXd terms(count, 1 + kBackgroundTerms);
        for (int i = 0; i < count; ++i) {
            const auto index = static_cast<std::size_t>(i);
            const glm::dvec2 at = 2.0 * glm::dvec2(cells[index].column, cells[index].row) / glm::dvec2(grid) - 1.0;
            terms.row(i) << measure.wanted[index] * (fallsOff ? cells[index].gain : 1), 1, at.x, at.y, at.x * at.x, at.x * at.y,
                at.y * at.y;
        }
        Eigen::MatrixXd normal = terms.transpose() * terms;
        normal.diagonal().tail(kBackgroundTerms).array() += kBackgroundCost * count;
        const Eigen::MatrixXd solved = normal.completeOrthogonalDecomposition().solve(terms.transpose());
        measure.background = terms.rightCols(kBackgroundTerms).cast<float>();
        measure.backgroundOf = solved.bottomRows(kBackgroundTerms).cast<float>();
        return measure;
    }

    // The light of every cell; nothing if the frame cannot be compared.
    std::optional<CellLight> lightOf(const RgbaImage& frame) const {
        if (frame.width() != frameSize.x || frame.height() != frameSize.y) return std::nullopt;
        if (static_cast<double>(cells.size()) < kMostlySeen * shown * grid.x * grid.y) return std::nullopt;
        CellLight result;
        for (const CanvasCell& cell : cells) {
            const glm::dvec3 mean = linearOf(light, frame, cell);
            for (int c = 0; c < 3; ++c) result[static_cast<std::size_t>(c)].push_back(static_cast<float>(mean[c]));
        }
        return result;
    }

    // The light of sky and lamps: per channel, because that light has a colour.
    CellLight backgroundIn(const CellLight& seen, const Measure& measure) const {
        const auto count = static_cast<int>(cells.size());
        CellLight result;
        for (std::size_t c = 0; c < seen.size(); ++c) {
            const std::vector<float> smooth = lowPassed(seen[c]);
            const Eigen::VectorXf share = measure.backgroundOf * Eigen::Map<const Eigen::VectorXf>(smooth.data(), count);
            result[c].resize(seen[c].size());
            Eigen::Map<Eigen::VectorXf>(result[c].data(), count) = measure.background * share;
        }
        return result;
    }

    // The picture's light, low-passed.
    std::vector<float> seenBy(const Measure& measure, const CellLight& cellLight) const {
        const CellLight background = backgroundIn(cellLight, measure);
        // A pixel's value is its brightest channel, so that shapes of any colour count alike.
        std::vector<float> seen;
        for (std::size_t i = 0; i < cells.size(); ++i)
            seen.push_back(std::max({cellLight[0][i] - background[0][i], cellLight[1][i] - background[1][i],
                                     cellLight[2][i] - background[2][i]}) /
                           measure.gain[i]);
        return lowPassed(seen);
    }

    // Nothing if there is no picture.
    std::optional<Comparison> compared(const std::vector<float>& seen) const {
        Comparison result{exposureOf(seen, z.wanted), {}};
        const Exposure& exposure = result.exposure;
        if (exposure.span < kFlat || exposure.scale <= 0) return std::nullopt;
        for (std::size_t i = 0; i < seen.size(); ++i)
            result.difference.push_back(std::clamp(exposure.scale * seen[i] + exposure.lift, 0.0, 1.0) - z.wanted[i]);
        return result;
    }
    std::optional<double> toneOf(const std::vector<float>& seen) const {
        const double constant = constantOf(seen, tone.wanted);
        if (constant <= 0) return std::nullopt;
        double difference = 0;
        for (std::size_t i = 0; i < seen.size(); ++i) difference += std::abs(constant * seen[i] - tone.wanted[i]);
        return std::min(1.0, difference / static_cast<double>(seen.size()));
    }
};

GuideComparison::GuideComparison(const NominalView& view, const GreyImage& wanted, const GreyImage& light) {
    FANTASCOPE_CHECK(!wanted.empty() && !light.empty(), "a guide must not be empty");
    auto tables = std::make_shared<Tables>();
    tables->frameSize = view.camera.size;
    tables->light = view.light;
    tables->grid = {std::max(1, static_cast<int>(std::lround(kRows * view.canvasAspect))), kRows};
    const CanvasPart part = view.warp.shown();
    tables->shown = (part.high.x - part.low.x) * (part.high.y - part.low.y);
    tables->cells = cellsInSight(view, tables->grid, kPlaces);
    tables_ = tables;
    if (tables->cells.empty()) return;

    GreyImage inSight(tables->grid.x, tables->grid.y);
    for (const CanvasCell& cell : tables->cells) inSight.at(cell.column, cell.row) = 1;
    tables->weights = blurred(inSight, kBlur * kRows);
    tables->z = tables->measureOf(wanted, !view.isEvenedOut);
    tables->tone = tables->measureOf(light, false);
}

std::optional<Likeness> GuideComparison::compare(const RgbaImage& frame) const {
    const Tables& tables = *tables_;
    const auto light = tables.lightOf(frame);
    if (!light) return std::nullopt;
    const auto compared = tables.compared(tables.seenBy(tables.z, *light));
    if (!compared) return std::nullopt;
    double z = 0;
    for (const double difference : compared->difference) z += std::abs(difference);
    return Likeness{z / static_cast<double>(compared->difference.size()), tables.toneOf(tables.seenBy(tables.tone, *light))};
}

std::optional<ComparedPictures> GuideComparison::pictures(const RgbaImage& frame) const {
    const Tables& tables = *tables_;
    const auto light = tables.lightOf(frame);
    if (!light) return std::nullopt;
    const auto compared = tables.compared(tables.seenBy(tables.z, *light));
    if (!compared) return std::nullopt;
    const CellLight background = tables.backgroundIn(*light, tables.z);
    const glm::ivec2 grid = tables.grid;
    const GreyImage none(grid.x, grid.y);
    ComparedPictures pictures{none, GreyImage(kPlaces * grid.x, kPlaces * grid.y), none, none};
    for (std::size_t i = 0; i < tables.cells.size(); ++i) {
        const CanvasCell& cell = tables.cells[i];
        const float gain = tables.z.gain[i];
        pictures.wanted.at(cell.column, cell.row) = tables.z.wanted[i] * gain;
        pictures.difference.at(cell.column, cell.row) = static_cast<float>(compared->difference[i]);
        pictures.inSight.at(cell.column, cell.row) = 1;
        for (int place = 0; place < kPlaces * kPlaces; ++place) {
            const glm::dvec3 here = linearAt(tables.light, frame, cell.places[static_cast<std::size_t>(place)]);
            const double brightest = std::max({here.r - background[0][i], here.g - background[1][i], here.b - background[2][i]});
            const double fitted = compared->exposure.scale * brightest / gain + compared->exposure.lift;
            pictures.seen.at(kPlaces * cell.column + place % kPlaces, kPlaces * cell.row + place / kPlaces) =
                static_cast<float>(std::clamp(fitted, 0.0, 1.0) * gain);
        }
    }
    return pictures;
}

}  // namespace fantascope::vision
