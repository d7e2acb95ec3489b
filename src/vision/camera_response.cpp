#include "vision/camera_response.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

namespace fantascope::vision {
namespace {

constexpr std::size_t kKnots = 18;  // every 15 stored values
constexpr double kStep = 255.0 / (kKnots - 1);
// Values beside these tell nothing: noise, and saturation that has begun.
constexpr double kAboveDark = 6, kBelowWhite = 5;
constexpr double kSmooth = 0.05;  // weight of the second differences beside one sample
constexpr int kRounds = 6;        // for the dark light, which is not proportional to the time
constexpr std::size_t kFewestKnots = 10, kFewestPixels = 20;

double srgb(double stored) { return linearFromSrgb(static_cast<float>(stored / 255)); }

// A value's place between two knots.
struct Place {
    std::size_t low;
    double share;
    explicit Place(double stored)
        : low(std::min(static_cast<std::size_t>(stored / kStep), kKnots - 2)), share(stored / kStep - static_cast<double>(low)) {}
};

// ln(light) = ln(sRGB's light) + a smooth curve.
struct Curve {
    std::array<double, kKnots> above{};
    double lightOf(double stored) const {
        const Place place(stored);
        return srgb(stored) * std::exp(std::lerp(above[place.low], above[place.low + 1], place.share));
    }
};

struct Sample {
    std::size_t pixel, exposure;
    double stored, logTime;
};

// The curve, and the logarithms of the pixels' light, by least squares. `dark`: light that is there
// without exposure. Returns the residuals' rms.
double solve(const std::vector<Sample>& samples, double dark, Curve& curve, std::vector<double>& logLights) {
    const auto unknowns = static_cast<Eigen::Index>(kKnots + logLights.size());
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
    const auto add = [&](std::initializer_list<std::pair<std::size_t, double>> row, double value, double weight) {
        for (const auto& [i, a] : row) {
            for (const auto& [j, b] : row) normal(Eigen::Index(i), Eigen::Index(j)) += weight * a * b;
            right(Eigen::Index(i)) += weight * a * value;
        }
    };
    for (const Sample& sample : samples) {
        const Place place(sample.stored);
        const double exposed = std::exp(logLights[sample.pixel] + sample.logTime);
        const double wanted = sample.logTime + std::log1p(dark / exposed) - std::log(srgb(sample.stored));
        add({{place.low, 1 - place.share}, {place.low + 1, place.share}, {kKnots + sample.pixel, -1}}, wanted, 1);
    }
    for (std::size_t knot = 1; knot + 1 < kKnots; ++knot)
        add({{knot - 1, 1}, {knot, -2}, {knot + 1, 1}}, 0, kSmooth * static_cast<double>(samples.size()) / kKnots);
    add({{kKnots - 1, 1}}, 0, 1);  // the unit of light is free
    for (Eigen::Index i = 0; i < unknowns; ++i) normal(i, i) += 1e-9;
    const Eigen::VectorXd found = normal.ldlt().solve(right);
    for (std::size_t knot = 0; knot < kKnots; ++knot) curve.above[knot] = found(Eigen::Index(knot));
    for (std::size_t pixel = 0; pixel < logLights.size(); ++pixel) logLights[pixel] = found(Eigen::Index(kKnots + pixel));
    double square = 0;
    for (const Sample& sample : samples) {
        const double light = std::exp(logLights[sample.pixel] + sample.logTime) + dark;
        square += std::pow(std::log(curve.lightOf(sample.stored) / light), 2);
    }
    return std::sqrt(square / static_cast<double>(samples.size()));
}

std::vector<double> valuesOf(const auto& lightOf, double dark) {
    const double least = lightOf(dark), most = lightOf(255);
    std::vector<double> values;
    for (std::size_t knot = 0; knot < kKnots; ++knot) {
        const double value = std::clamp((lightOf(kStep * static_cast<double>(knot)) - least) / (most - least), 0.0, 1.0);
        values.push_back(values.empty() ? 0 : std::max(values.back(), value));
    }
    values.back() = 1;
    return values;
}

}  // namespace

Result<ResponseFit> fitResponse(std::span<const ExposedValues> exposures, double dark) {
    std::vector<Sample> samples;
    std::array<bool, kKnots> told{};
    std::size_t pixels = 0;
    std::vector<double> logLights;
    const std::size_t all = exposures.empty() ? 0 : exposures[0].stored.size();
    for (std::size_t pixel = 0; pixel < all; ++pixel) {
        std::vector<Sample> its;
        for (std::size_t exposure = 0; exposure < exposures.size(); ++exposure) {
            const double stored = exposures[exposure].stored[pixel];
            if (stored > dark + kAboveDark && stored < 255 - kBelowWhite)
                its.push_back({pixels, exposure, stored, std::log(exposures[exposure].time)});
        }
        if (its.size() < 2) continue;  // one value says nothing of ratios
        for (const Sample& sample : its) told[Place(sample.stored).low] = true;
        logLights.push_back(std::log(srgb(its[0].stored)) - its[0].logTime);
        samples.insert(samples.end(), its.begin(), its.end());
        ++pixels;
    }
    if (pixels < kFewestPixels || static_cast<std::size_t>(std::ranges::count(told, true)) < kFewestKnots)
        return Error("the exposures tell of too few values; show the camera something still with dark, middle and bright parts");
    ResponseFit fit;
    Curve curve;
    for (int round = 0; round < kRounds; ++round) fit.rms = solve(samples, curve.lightOf(dark), curve, logLights);
    fit.response = valuesOf([&](double stored) { return curve.lightOf(stored); }, dark);
    return fit;
}

std::vector<double> srgbResponse(double dark) { return valuesOf(srgb, dark); }

DarkFrame darkFrameOf(const GreyImage& stored) {
    constexpr double kHot = 12;        // stored values above the median, at least
    constexpr double kDeviations = 8;  // ... and so many standard deviations
    constexpr double kNormal = 1.4826;
    std::vector<float> values(stored.pixels().begin(), stored.pixels().end());
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    DarkFrame dark{.level = *middle, .hotPixels = {}};
    for (float& value : values) value = std::abs(value - static_cast<float>(dark.level));
    std::ranges::nth_element(values, middle);
    const double limit = dark.level + std::max(kHot, kDeviations * kNormal * *middle);
    for (int y = 0; y < stored.height(); ++y)
        for (int x = 0; x < stored.width(); ++x)
            if (stored.at(x, y) > limit) dark.hotPixels.emplace_back(x, y);
    return dark;
}

}  // namespace fantascope::vision
