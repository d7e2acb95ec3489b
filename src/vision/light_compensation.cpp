#include "vision/light_compensation.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace fantascope::vision {
namespace {

constexpr std::size_t kFewestPlaces = 100;  // camera pixels
// A place counts if the outputs that the camera knows there give this share of its light.
constexpr double kMostOfIt = 0.9;
// The standard deviation of the smoothing: in projector pixels at least, and in camera pixels at
// least. Where light changes tenfold at an edge, half a projector pixel then changes a factor by
// less than a tenth.
constexpr double kSmoothProjector = 4, kSmoothCamera = 1.2;
constexpr double kSame = 0.1;  // a place is as bright as the others within this share

// Values at places of a grid that were met, and how much each was.
struct Sums {
    GreyImage value, weight;
    Sums(int width, int height) : value(width, height), weight(width, height) {}

    // Spreads a value over the four cells around a place, in cells.
    void add(glm::dvec2 at, double what) {
        const glm::dvec2 corner = glm::floor(at - 0.5), share = at - 0.5 - corner;
        for (int i = 0; i < 4; ++i) {
            const int x = std::clamp(static_cast<int>(corner.x) + i % 2, 0, value.width() - 1),
                      y = std::clamp(static_cast<int>(corner.y) + i / 2, 0, value.height() - 1);
            const double part = (i % 2 == 0 ? 1 - share.x : share.x) * (i / 2 == 0 ? 1 - share.y : share.y);
            value.at(x, y) += static_cast<float>(part * what);
            weight.at(x, y) += static_cast<float>(part);
        }
    }
};

// The mean values of all cells. A cell that was hardly met takes the rest from its neighbourhood,
// as far away as need be (Gortler et al. 1996, push and pull).
GreyImage filled(const Sums& sums) {
    const int width = sums.value.width(), height = sums.value.height();
    GreyImage result(width, height);
    GreyImage coarse;
    if (std::max(width, height) > 1) {
        Sums half((width + 1) / 2, (height + 1) / 2);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                half.value.at(x / 2, y / 2) += sums.value.at(x, y);
                half.weight.at(x / 2, y / 2) += sums.weight.at(x, y);
            }
        coarse = resized(filled(half), 2 * half.value.width(), 2 * half.value.height());
    }
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float weight = sums.weight.at(x, y), own = std::min(weight, 1.0f);
            const float mean = weight > 0 ? sums.value.at(x, y) / weight : 0, around = coarse.empty() ? mean : coarse.at(x, y);
            result.at(x, y) = own * mean + (1 - own) * around;
        }
    return result;
}

// Projector pixels across one camera pixel.
double magnification(const ProjectorMap& map, glm::ivec2 size) {
    glm::dvec2 low(size), high(0);
    for (const glm::vec2 at : map.at.pixels()) {
        if (at.x != at.x) continue;
        low = glm::min(low, glm::dvec2(at)), high = glm::max(high, glm::dvec2(at));
    }
    const glm::dvec2 lit = glm::max(high - low, 1.0);
    return std::sqrt(lit.x * lit.y / static_cast<double>(std::max<std::size_t>(map.known, 1)));
}

// Values of camera pixels by projector pixel.
GreyImage byProjectorPixel(const ProjectorMap& map, glm::ivec2 size, const GreyImage& values) {
    const int cell = std::max(1, static_cast<int>(magnification(map, size)));
    const glm::ivec2 cells = (size + cell - 1) / cell;
    Sums sums(cells.x, cells.y);
    for (int y = 0; y < values.height(); ++y)
        for (int x = 0; x < values.width(); ++x)
            if (map.isKnown(x, y)) sums.add(glm::dvec2(map.at.at(x, y)) / double(cell), values.at(x, y));
    const GreyImage all = resized(blurred(filled(sums), 0.7), cells.x * cell, cells.y * cell);
    GreyImage cut(size.x, size.y);
    for (int y = 0; y < size.y; ++y) std::copy_n(all.row(y).begin(), size.x, cut.row(y).begin());
    return cut;
}

GreyImage quotient(GreyImage values, const GreyImage& weights) {
    for (std::size_t i = 0; i < values.pixels().size(); ++i) values.pixels()[i] /= std::max(weights.pixels()[i], 1e-6f);
    return values;
}

// The light of a white canvas as the camera sees it, and where it sees enough of it.
struct Canvas {
    GreyImage light, seen;
    std::size_t places = 0;
    double smooth = 0;  // standard deviation, camera pixels
};

Canvas canvasOf(std::span<const LitOutput> outputs) {
    const ProjectorMap& first = *outputs.front().map;
    Canvas canvas{GreyImage(first.at.width(), first.at.height()), GreyImage(first.at.width(), first.at.height())};
    double finest = INFINITY;
    for (const LitOutput& output : outputs)
        finest = std::min(finest, magnification(*output.map, {output.share->width(), output.share->height()}));
    canvas.smooth = std::max(kSmoothCamera, kSmoothProjector / finest);
    for (int y = 0; y < canvas.light.height(); ++y)
        for (int x = 0; x < canvas.light.width(); ++x) {
            double known = 0, light = 0;
            for (const LitOutput& output : outputs) {
                if (!output.map->isKnown(x, y)) continue;
                const GreyImage& shares = *output.share;
                const glm::ivec2 at = glm::clamp(glm::ivec2(output.map->at.at(x, y)), glm::ivec2(0),
                                                 glm::ivec2(shares.width(), shares.height()) - 1);
                const double share = shares.at(at.x, at.y);
                known += share;
                light += share * output.brightness * output.map->light.at(x, y);
            }
            if (known < kMostOfIt) continue;
            canvas.light.at(x, y) = static_cast<float>(light);
            canvas.seen.at(x, y) = 1;
            ++canvas.places;
        }
    return canvas;
}

double quantile(std::vector<float> values, double share) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

double spreadOf(const std::vector<float>& light) {
    double mean = 0, difference = 0;
    for (const float one : light) mean += one / static_cast<double>(light.size());
    for (const float one : light) difference += std::abs(one - mean) / static_cast<double>(light.size());
    return difference / mean;
}

}  // namespace

std::optional<LightCompensation> compensateLight(std::span<const LitOutput> outputs, const LightBounds& bounds) {
    const Canvas canvas = canvasOf(outputs);
    if (canvas.places < kFewestPlaces) return std::nullopt;
    const GreyImage around = blurred(canvas.seen, canvas.smooth);
    const GreyImage light = quotient(blurred(canvas.light, canvas.smooth), around);
    std::vector<float> places;
    for (std::size_t i = 0; i < light.pixels().size(); ++i)
        if (canvas.seen.pixels()[i] > 0) places.push_back(light.pixels()[i]);
    const double level = std::max(quantile(places, bounds.clipped), bounds.least * quantile(places, 1 - bounds.clipped));
    if (level <= 0) return std::nullopt;

    GreyImage gain(light.width(), light.height());
    for (std::size_t i = 0; i < gain.pixels().size(); ++i)
        if (canvas.seen.pixels()[i] > 0)
            gain.pixels()[i] = static_cast<float>(std::clamp(level / light.pixels()[i], bounds.least, 1.0));
    gain = quotient(blurred(gain, canvas.smooth), around);

    LightCompensation compensation;
    std::vector<float> compensated;
    double before = 0, after = 0;
    for (std::size_t i = 0; i < gain.pixels().size(); ++i) {
        if (canvas.seen.pixels()[i] <= 0) continue;
        const double full = light.pixels()[i], now = full * gain.pixels()[i], part = 1.0 / static_cast<double>(canvas.places);
        before += full, after += now;
        if (now < (1 - kSame) * level) compensation.tooDark += part;
        if (now > (1 + kSame) * level) compensation.tooBright += part;
        compensated.push_back(static_cast<float>(now));
    }
    compensation.kept = after / before;
    compensation.spreadBefore = spreadOf(places);
    compensation.spread = spreadOf(compensated);
    for (const LitOutput& output : outputs) {
        ProjectorMap inSight = *output.map;
        for (std::size_t i = 0; i < inSight.at.pixels().size(); ++i)
            if (canvas.seen.pixels()[i] <= 0) inSight.at.pixels()[i] = glm::vec2(NAN);
        compensation.gains.push_back(byProjectorPixel(inSight, {output.share->width(), output.share->height()}, gain));
    }
    return compensation;
}

std::optional<GreyImage> lightByProjectorPixel(const ProjectorMap& map, glm::ivec2 size) {
    if (map.known < kFewestPlaces) return std::nullopt;
    return byProjectorPixel(map, size, map.light);
}

}  // namespace fantascope::vision
