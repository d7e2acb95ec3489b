#include "vision/projector_response.h"

#include "core/check.h"

#include <Eigen/Dense>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace fantascope::vision {
namespace {

constexpr int kLeastGamma = 1000, kMostGamma = 4000;  // thousandths
constexpr std::size_t kFewestGreys = 5;
constexpr double kStrayGrey = 0.03;  // of white's light: a grey that is farther from the curve does not count
// A pixel is saturated at its end of the range, or if its neighbourhood is nearly there on average:
// which of its pixels the noise cuts off is chance.
constexpr float kSaturated = 0.999f, kNearlySaturated = 0.95f;
constexpr int kNeighbourhood = 2;  // pixels on each side
// A pixel is undecided where a picture differs by more from what the others say: as a share of the
// full light, and as a multiple of the usual difference.
constexpr float kMovedLight = 0.2f, kMovedUsual = 5;
constexpr std::size_t kFewestShared = 50;  // camera pixels
// Less than this share of the primaries' volume, and the camera does not tell them apart.
constexpr double kApart = 0.05;

double medianOf(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

float greyOf(const glm::vec3& light) { return (light.r + light.g + light.b) / 3; }

float brightestOf(const glm::vec3& light) { return std::max({light.r, light.g, light.b}); }

bool isSaturated(const Image<glm::vec3>& picture, std::size_t pixel) {
    if (brightestOf(picture.pixels()[pixel]) >= kSaturated) return true;
    const auto width = static_cast<std::size_t>(picture.width());
    const int x = static_cast<int>(pixel % width), y = static_cast<int>(pixel / width);
    glm::vec3 sum(0);
    int count = 0;
    for (int v = std::max(0, y - kNeighbourhood); v <= std::min(picture.height() - 1, y + kNeighbourhood); ++v)
        for (int u = std::max(0, x - kNeighbourhood); u <= std::min(picture.width() - 1, x + kNeighbourhood); ++u, ++count)
            sum += picture.at(u, v);
    return brightestOf(sum) > kNearlySaturated * static_cast<float>(count);
}

// light = stored ^ gamma - excess (1 - stored ^ gamma), with the excess of the black's light.
struct GreyCurve {
    double gamma = 0, excess = 0, error = std::numeric_limits<double>::infinity();

    double at(double stored) const { return std::pow(stored, gamma) - excess * (1 - std::pow(stored, gamma)); }
};

GreyCurve curveThrough(const std::vector<GreyLight>& greys) {
    GreyCurve best;
    for (int thousandths = kLeastGamma; thousandths <= kMostGamma; ++thousandths) {
        const double gamma = thousandths / 1000.0;
        double product = 0, square = 0;
        for (const GreyLight& grey : greys) {
            const double power = std::pow(grey.stored, gamma);
            product += (power - grey.light) * (1 - power);
            square += (1 - power) * (1 - power);
        }
        GreyCurve curve{gamma, product / square, 0};
        for (const GreyLight& grey : greys) curve.error += std::pow(grey.light - curve.at(grey.stored), 2);
        if (curve.error < best.error) best = curve;
    }
    return best;
}

// The white of one output in the primaries of another, as shares of the other's own white.
std::optional<glm::dvec3> whiteIn(const PrimaryLight& white, const PrimaryLight& primaries) {
    const glm::dmat3 inverse = glm::inverse(glm::dmat3(primaries.primaries));
    const glm::dvec3 ratio = inverse * glm::dvec3(white.white) / (inverse * glm::dvec3(primaries.white));
    for (int i = 0; i < 3; ++i)
        if (!(ratio[i] > 0 && std::isfinite(ratio[i]))) return std::nullopt;
    return ratio;
}

double apart(const glm::mat3& primaries) {
    const double most = double(glm::length(primaries[0])) * double(glm::length(primaries[1])) * double(glm::length(primaries[2]));
    return most > 0 ? std::abs(double(glm::determinant(primaries))) / most : 0;
}

// The logarithm of how much stronger an output's primaries are than another's, where both light the
// wall.
struct Strength {
    glm::dvec3 log{0};
    double pixels = 0;
};

Strength strengthOver(const std::vector<PrimaryLight>& output, const std::vector<PrimaryLight>& other) {
    std::vector<std::pair<const PrimaryLight*, const PrimaryLight*>> shared;
    for (auto a = output.begin(), b = other.begin(); a != output.end() && b != other.end();)
        if (a->pixel == b->pixel)
            shared.emplace_back(&*a++, &*b++);
        else
            ++(a->pixel < b->pixel ? a : b);
    if (shared.size() < kFewestShared) return {};
    std::vector<double> volumes;
    volumes.reserve(shared.size());
    for (const auto& [a, b] : shared) volumes.push_back(std::min(apart(a->primaries), apart(b->primaries)));
    const bool colours = medianOf(volumes) > kApart;
    std::array<std::vector<double>, 3> logs;
    for (const auto& [a, b] : shared) {
        const auto there = whiteIn(*a, *b), back = whiteIn(*b, *a);
        for (std::size_t i = 0; i < 3; ++i) {
            const auto channel = static_cast<int>(i);
            if (!colours)
                logs[i].push_back(std::log(double(greyOf(a->white)) / double(greyOf(b->white))));
            else if (there && back)
                logs[i].push_back((std::log((*there)[channel]) - std::log((*back)[channel])) / 2);
        }
    }
    if (logs[0].size() < kFewestShared / 2) return {};
    return {{medianOf(logs[0]), medianOf(logs[1]), medianOf(logs[2])}, static_cast<double>(shared.size())};
}

}  // namespace

std::optional<double> fitGamma(std::vector<GreyLight> greys) {
    while (greys.size() >= kFewestGreys) {
        const GreyCurve curve = curveThrough(greys);
        const auto off = [&](const GreyLight& grey) { return std::abs(grey.light - curve.at(grey.stored)); };
        const auto worst = std::ranges::max_element(greys, {}, off);
        if (off(*worst) <= kStrayGrey) {
            const bool within = curve.gamma > kLeastGamma / 1000.0 && curve.gamma < kMostGamma / 1000.0;
            return within ? std::optional(curve.gamma) : std::nullopt;
        }
        greys.erase(worst);
    }
    return std::nullopt;
}

PrimarySight::PrimarySight(const LightDecoder& sight) {
    for (const std::size_t pixel : sight.litPixels()) {
        Pixel& added = pixels_.emplace_back();
        added.full = sight.full().pixels()[pixel];
        added.dark = sight.dark().pixels()[pixel];
        added.light.pixel = pixel;
    }
}

void PrimarySight::take(const Pictures& pictures) {
    // The greatest difference of a pixel from what the others say of it. The primaries of some
    // projectors do not add up to their white.
    std::vector<double> sums, errors;
    const auto at = [&](const Pixel& pixel, std::size_t picture) { return pictures[picture].pixels()[pixel.light.pixel]; };
    const auto sumOf = [&](const Pixel& pixel) {
        return greyOf(at(pixel, 1) + at(pixel, 2) + at(pixel, 3) - 3.0f * at(pixel, 0)) / (pixel.full - pixel.dark);
    };
    for (const Pixel& pixel : pixels_) sums.push_back(double(sumOf(pixel)));
    if (sums.empty()) return;
    const auto usualSum = static_cast<float>(medianOf(sums));
    const auto errorOf = [&](const Pixel& pixel) {
        return std::max({std::abs(greyOf(at(pixel, 0)) - pixel.dark), std::abs(greyOf(at(pixel, 4)) - pixel.full),
                         std::abs(sumOf(pixel) - usualSum) * (pixel.full - pixel.dark)});
    };
    for (const Pixel& pixel : pixels_) errors.push_back(double(errorOf(pixel)));
    const float usual = kMovedUsual * static_cast<float>(medianOf(errors));
    for (Pixel& pixel : pixels_) {
        if (pixel.state != State::Undecided) continue;
        const glm::vec3 white = at(pixel, 4), black = at(pixel, 0);
        if (isSaturated(pictures[4], pixel.light.pixel)) {
            pixel.state = State::Saturated;
        } else if (errorOf(pixel) <= std::max(kMovedLight * (pixel.full - pixel.dark), usual)) {
            pixel.state = State::Known;
            pixel.light.primaries = {at(pixel, 1) - black, at(pixel, 2) - black, at(pixel, 3) - black};
            pixel.light.white = white - black;
        }
    }
}

double PrimarySight::undecided() const {
    const auto count = std::ranges::count(pixels_, State::Undecided, &Pixel::state);
    return pixels_.empty() ? 0 : static_cast<double>(count) / static_cast<double>(pixels_.size());
}

std::vector<PrimaryLight> PrimarySight::light() const {
    std::vector<PrimaryLight> known;
    for (const Pixel& pixel : pixels_)
        if (pixel.state == State::Known) known.push_back(pixel.light);
    return known;
}

std::optional<std::vector<glm::dvec3>> matchedWhites(std::span<const std::vector<PrimaryLight>> outputs) {
    // Least squares of the logarithms of the outputs' strengths; that of the first is free.
    const auto count = static_cast<Eigen::Index>(outputs.size());
    FANTASCOPE_CHECK(count > 0, "whites of outputs");
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(count, count);
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count, 3);
    for (Eigen::Index i = 0; i < count; ++i)
        for (Eigen::Index j = 0; j < i; ++j) {
            const Strength over = strengthOver(outputs[static_cast<std::size_t>(i)], outputs[static_cast<std::size_t>(j)]);
            normal(i, i) += over.pixels;
            normal(j, j) += over.pixels;
            normal(i, j) -= over.pixels;
            normal(j, i) -= over.pixels;
            const Eigen::RowVector3d difference(over.log.x, over.log.y, over.log.z);
            right.row(i) += over.pixels * difference;
            right.row(j) -= over.pixels * difference;
        }
    normal(0, 0) += 1;
    const Eigen::FullPivLU<Eigen::MatrixXd> solver(normal);
    if (!solver.isInvertible()) return std::nullopt;  // an output shares no light with the others
    const Eigen::MatrixXd strengths = solver.solve(right);
    std::vector<glm::dvec3> whites;
    for (Eigen::Index i = 0; i < count; ++i) {
        const auto factor = [&](Eigen::Index channel) {
            return std::exp(strengths.col(channel).minCoeff() - strengths(i, channel));
        };
        whites.emplace_back(factor(0), factor(1), factor(2));
    }
    return whites;
}

}  // namespace fantascope::vision
