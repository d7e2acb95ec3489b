#include "vision/watch/registration.h"

#include "core/check.h"
#include "core/median.h"

#include <Eigen/Dense>
#include <glm/common.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace fantascope::vision {
namespace {

constexpr int kCoarsest = 24;           // least number of pixels across and down on the coarsest level
constexpr int kNeighbourhood = 13;      // side of a pixel's neighbourhood, pixels of the level
constexpr double kFarthest = 0.1;       // of the wide search, in picture widths
constexpr double kBiweight = 4.685;     // 95 % efficient for Gaussian residuals
constexpr int kNearSteps = 2;           // a picture that is followed moves little from one sight to the next
constexpr double kStill = 0.005;        // pixels: a smaller step ends the iteration
constexpr double kCorrelated = 2;       // so many neighbouring residuals are as good as one, because pictures are blurred
constexpr double kFlatPixel = 0.1;      // slope, in rms of the expected picture
constexpr double kContent = 0.3;        // a pixel has content if it differs so much, in rms of the expected picture
constexpr double kLeastContent = 1e-4;  // rms of the expected picture, below which there is nothing to register

// The movements that are estimated, in this order: right, down, larger, turned, two shears, two
// keystones. A coarse level estimates only the first of them.
constexpr int kShift = 2, kSimilarity = 4, kProjective = 8;
using Step = Eigen::Matrix<double, kProjective, 1>;
using Normal = Eigen::Matrix<double, kProjective, kProjective>;

struct Level {
    cv::Mat seen, expected, mask;  // CV_32F, of one size
};

cv::Mat matOf(const GreyImage& image) {
    return {image.height(), image.width(), CV_32F, const_cast<float*>(image.pixels().data())};
}

// Every level has half the pixels of the level before, across and down.
std::vector<Level> levelsOf(const GreyImage& seen, const GreyImage& expected, const GreyImage& mask) {
    std::vector<Level> levels{{matOf(seen).mul(matOf(mask)), matOf(expected), matOf(mask)}};
    while (std::min(levels.back().seen.cols, levels.back().seen.rows) >= 2 * kCoarsest) {
        const Level& fine = levels.back();
        Level half;
        const cv::Size size(fine.seen.cols / 2, fine.seen.rows / 2);
        cv::resize(fine.seen, half.seen, size, 0, 0, cv::INTER_AREA);
        cv::resize(fine.expected, half.expected, size, 0, 0, cv::INTER_AREA);
        cv::resize(fine.mask, half.mask, size, 0, 0, cv::INTER_AREA);
        levels.push_back(std::move(half));
    }
    return levels;
}

// The sum over each pixel's neighbourhood.
cv::Mat aroundOf(const cv::Mat& image) {
    cv::Mat sum;
    cv::boxFilter(image, sum, CV_32F, {kNeighbourhood, kNeighbourhood}, cv::Point(-1, -1), false, cv::BORDER_CONSTANT);
    return sum;
}

// What differs from the neighbourhood. `image` is 0 where `mask` is; `weight`: the sum of the mask
// over each neighbourhood.
cv::Mat detailOf(const cv::Mat& image, const cv::Mat& mask, const cv::Mat& weight) {
    cv::Mat mean = aroundOf(image);
    cv::divide(mean, weight, mean);
    cv::Mat detail = image - mean.mul(mask);
    return detail;
}

// One level's comparison under a map: details of both pictures, and the weight of every pixel.
class Comparison {
public:
    Comparison(const Level& level, const Homography& map) : size_(level.seen.size()) {
        cv::Mat x(size_, CV_32F), y(size_, CV_32F), inside(size_, CV_32F);
        for (int row = 0; row < size_.height; ++row) {
            auto *xs = x.ptr<float>(row), *ys = y.ptr<float>(row), *in = inside.ptr<float>(row);
            for (int column = 0; column < size_.width; ++column) {
                const glm::dvec2 at = map({column + 0.5, row + 0.5});
                xs[column] = static_cast<float>(at.x - 0.5);
                ys[column] = static_cast<float>(at.y - 0.5);
                in[column] = at.x >= 0 && at.y >= 0 && at.x <= size_.width && at.y <= size_.height ? 1.0f : 0.0f;
            }
        }
        mask_ = level.mask.mul(inside);
        cv::Mat moved;
        cv::remap(level.expected, moved, x, y, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
        const cv::Mat weight = cv::max(aroundOf(mask_), 1e-3);
        expected_ = detailOf(moved.mul(mask_), mask_, weight);
        seen_ = detailOf(level.seen.mul(inside), mask_, weight);
        weigh();
    }

    double content() const { return content_; }  // rms of the expected details
    double gain() const { return gain_; }
    double used() const { return used_; }
    double agreement() const { return agreement_; }

    // The normal equations of the next step for the first `count` movements.
    void equations(int count, Normal& normal, Step& right) const {
        normal.setZero();
        right.setZero();
        const double half = size_.width / 2.0,
                     flat = kFlatPixel * gain_ * content_;  // such pixels are many, and say next to nothing
        for (int row = 1; row + 1 < size_.height; ++row) {
            const auto *up = expected_.ptr<float>(row - 1), *here = expected_.ptr<float>(row),
                       *down = expected_.ptr<float>(row + 1), *seen = seen_.ptr<float>(row), *weight = weight_.ptr<float>(row);
            for (int column = 1; column + 1 < size_.width; ++column) {
                if (weight[column] <= 0) continue;
                const double gx = gain_ * (here[column + 1] - here[column - 1]) / 2, gy = gain_ * (down[column] - up[column]) / 2;
                if (std::abs(gx) + std::abs(gy) < flat) continue;
                const double u = (column + 0.5 - half) / half, v = (row + 0.5 - size_.height / 2.0) / half;
                Step slope;
                slope << gx, gy, gx * u + gy * v, gy * u - gx * v, gx * u - gy * v, gx * v + gy * u, (gx * u + gy * v) * u,
                    (gx * u + gy * v) * v;
                slope.tail(kProjective - count).setZero();
                const double residual = seen[column] - gain_ * here[column];
                normal.selfadjointView<Eigen::Lower>().rankUpdate(slope, weight[column]);
                right += weight[column] * residual * slope;
            }
        }
        normal = normal.selfadjointView<Eigen::Lower>();
        for (int i = count; i < kProjective; ++i) normal(i, i) = 1;
    }

    // The rectangle that has all the content, in halves of the width from the picture's middle.
    std::array<glm::dvec2, 2> contentBox() const {
        cv::Mat content = cv::abs(expected_) > kContent * content_;
        const cv::Rect box = cv::boundingRect(content);
        const double half = size_.width / 2.0;
        const glm::dvec2 middle(half, size_.height / 2.0);
        return {(glm::dvec2(box.x, box.y) - middle) / half, (glm::dvec2(box.x + box.width, box.y + box.height) - middle) / half};
    }
    // Variance of the residuals of the pixels that agree.
    double variance() const { return variance_; }

private:
    // Gain, residuals' spread and weights depend on each other, so they are found in turn.
    void weigh() {
        const cv::Mat squared = expected_.mul(expected_), product = seen_.mul(expected_);
        content_ = std::sqrt(cv::mean(squared)[0]);
        weight_ = mask_.clone();
        for (int turn = 0; turn < 2; ++turn) {
            const double power = weight_.dot(squared);
            gain_ = power > 0 ? weight_.dot(product) / power : 0;
            reweigh();
        }
        const double both = weight_.dot(product), ours = weight_.dot(squared), theirs = weight_.dot(seen_.mul(seen_));
        agreement_ = ours > 0 && theirs > 0 ? both / std::sqrt(ours * theirs) : 0;
        const cv::Mat residual = seen_ - gain_ * expected_;
        const double weights = cv::sum(weight_)[0];
        variance_ = weights > 0 ? weight_.dot(residual.mul(residual)) / weights : 0;
    }

    void reweigh() {
        const cv::Mat residual = seen_ - gain_ * expected_;
        const auto threshold = static_cast<float>(kContent * content_);
        const auto hasContent = [&](float mask, float expected) { return mask > 0.5f && std::abs(expected) > threshold; };
        std::vector<float> spread;
        for (int row = 0; row < size_.height; ++row) {
            const auto *mask = mask_.ptr<float>(row), *expected = expected_.ptr<float>(row), *off = residual.ptr<float>(row);
            for (int column = 0; column < size_.width; ++column)
                if (hasContent(mask[column], expected[column])) spread.push_back(std::abs(off[column]));
        }
        used_ = 0;
        if (spread.empty()) {
            weight_.setTo(0);
            return;
        }
        const double withContent = static_cast<double>(spread.size());
        const auto cut = static_cast<float>(kBiweight * 1.4826 * std::max(medianOf(std::move(spread)), 1e-6f));
        for (int row = 0; row < size_.height; ++row) {
            const auto *mask = mask_.ptr<float>(row), *expected = expected_.ptr<float>(row), *off = residual.ptr<float>(row);
            auto* weight = weight_.ptr<float>(row);
            for (int column = 0; column < size_.width; ++column) {
                const float share = off[column] / cut, left = std::max(0.0f, 1 - share * share);
                weight[column] = mask[column] * left * left;
            }
            for (int column = 0; column < size_.width; ++column)
                if (hasContent(mask[column], expected[column])) used_ += weight[column] / withContent;
        }
    }

    cv::Size size_;
    cv::Mat seen_, expected_, mask_, weight_;
    double content_ = 0, gain_ = 0, used_ = 0, agreement_ = 0, variance_ = 0;
};

// A small movement in pixels of a picture that is `size` large, applied before `map`.
Homography moved(const Homography& map, const Step& step, cv::Size size) {
    const double half = size.width / 2.0;
    glm::dmat3 small(1.0);  // in halves of the width from the picture's middle; [column][row]
    small[0] = {1 + (step[2] + step[4]) / half, (step[3] + step[5]) / half, -step[6] / half};
    small[1] = {(step[5] - step[3]) / half, 1 + (step[2] - step[4]) / half, -step[7] / half};
    small[2] = {step[0] / half, step[1] / half, 1};
    const glm::dmat3 fromHalves(half, 0, 0, 0, half, 0, half, size.height / 2.0, 1);
    return map * Homography(fromHalves * small * glm::inverse(fromHalves));
}

// The movements of a map, to first order: the inverse of moved().
Step movementsOf(const Homography& map, cv::Size size) {
    const double half = size.width / 2.0;
    const glm::dmat3 fromHalves(half, 0, 0, 0, half, 0, half, size.height / 2.0, 1);
    glm::dmat3 small = glm::inverse(fromHalves) * map.matrix() * fromHalves;
    small /= small[2][2];
    Step step;
    step << small[2][0], small[2][1], (small[0][0] + small[1][1] - 2) / 2, (small[0][1] - small[1][0]) / 2,
        (small[0][0] - small[1][1]) / 2, (small[0][1] + small[1][0]) / 2, -small[0][2], -small[1][2];
    return half * step;
}

// What is known before anything is seen. A projector that is pushed mostly turns: the picture
// shifts, and turns about its middle, and a shift brings a little keystone along. Other movements
// are small, and a picture with content in its middle alone must not pretend them.
struct Prior {
    static constexpr double kKeystone = 0.11;  // of a shift: (half the picture's width / its distance)^2 at a throw ratio of 1.5
    Normal precision = Normal::Zero();
    Step towards = Step::Zero();  // precision x what is missing

    Prior(const Homography& map, cv::Size size, double perPixel) {
        const Step now = movementsOf(map, size);
        const double shift = std::hypot(now[0], now[1]), deviation = 0.1 * perPixel + 0.03 * shift;
        Eigen::Matrix<double, 5, kProjective> rest = Eigen::Matrix<double, 5, kProjective>::Zero();
        rest(0, 2) = rest(1, 4) = rest(2, 5) = rest(3, 6) = rest(4, 7) = 1;
        rest(3, 0) = rest(4, 1) = -kKeystone;
        precision = rest.transpose() * rest / (deviation * deviation);
        towards = -precision * now;
    }
};

// rms over a part of the picture of the movement's standard deviation. `information`: the inverse
// of its covariance.
double sigmaOf(const Normal& information, const std::array<glm::dvec2, 2>& part) {
    const Normal covariance = information.inverse();
    double sum = 0;
    constexpr int kPlaces = 5;
    for (int i = 0; i < kPlaces * kPlaces; ++i) {
        const glm::dvec2 at = glm::mix(part[0], part[1], glm::dvec2(i % kPlaces, i / kPlaces) / (kPlaces - 1.0));
        const double u = at.x, v = at.y;
        Eigen::Matrix<double, 2, kProjective> by;
        by << 1, 0, u, -v, u, v, u * u, u * v, 0, 1, v, u, -v, u, u * v, v * v;
        sum += (by * covariance * by.transpose()).trace() / (kPlaces * kPlaces);
    }
    return std::sqrt(std::max(0.0, sum));
}

// Improves the map on one level.
// `perPixel`: pixels of this level along one of the finest.
Homography refined(const Level& level, Homography map, int count, int steps, double perPixel) {
    for (int i = 0; i < steps; ++i) {
        const Comparison comparison(level, map);
        if (comparison.content() < kLeastContent) return map;
        Normal normal;
        Step right;
        comparison.equations(count, normal, right);
        if (comparison.variance() <= 0) return map;
        const double noise = kCorrelated * comparison.variance();
        normal.topLeftCorner(count, count) /= noise;
        right /= noise;
        const Prior prior(map, level.seen.size(), perPixel);
        normal.topLeftCorner(count, count) += prior.precision.topLeftCorner(count, count);
        right.head(count) += prior.towards.head(count);
        normal.diagonal().head(count).array() += 1e-3;  // a shift without any content stays as it is
        const Step step = normal.ldlt().solve(right);
        if (!step.allFinite() || step.norm() > level.seen.cols) return map;
        map = moved(map, step, level.seen.size());
        if (step.norm() < kStill) break;
    }
    return map;
}

// The best shift of a level, to whole pixels, after `map`.
Homography shifted(const Level& level, const Homography& map) {
    const int farthest = std::max(1, static_cast<int>(std::lround(kFarthest * level.seen.cols)));
    Homography best = map;
    double most = -1;
    for (int y = -farthest; y <= farthest; ++y)
        for (int x = -farthest; x <= farthest; ++x) {
            const Homography there = Homography(glm::dmat3(1, 0, 0, 0, 1, 0, x, y, 1)) * map;
            const Comparison comparison(level, there);
            const double score = comparison.gain() > 0 ? comparison.agreement() * comparison.used() : -1;
            if (score <= most) continue;
            most = score;
            best = there;
        }
    return best;
}

Homography scaled(const Homography& map, double x, double y) {
    const glm::dmat3 scale(x, 0, 0, 0, y, 0, 0, 0, 1);
    return Homography(scale * map.matrix() * glm::inverse(scale));
}

}  // namespace

std::optional<Registration> registerPictures(const GreyImage& seen, const GreyImage& expected, const GreyImage& mask,
                                             const Homography& start, SearchRange range) {
    FANTASCOPE_CHECK(seen.width() == expected.width() && seen.height() == expected.height() && seen.width() == mask.width() &&
                         seen.height() == mask.height(),
                     "pictures that are registered have one size");
    const std::vector<Level> levels = levelsOf(seen, expected, mask);
    Homography map = start;
    const int coarsest = range == SearchRange::Wide ? static_cast<int>(levels.size()) - 1 : 0;
    const auto sizeOf = [&](int level) { return levels[static_cast<std::size_t>(level)].seen.size(); };
    map = scaled(map, static_cast<double>(sizeOf(coarsest).width) / seen.width(),
                 static_cast<double>(sizeOf(coarsest).height) / seen.height());
    for (int level = coarsest; level >= 0; --level) {
        const Level& now = levels[static_cast<std::size_t>(level)];
        const double perPixel = static_cast<double>(sizeOf(level).width) / seen.width();
        if (range == SearchRange::Wide && level == coarsest) map = refined(now, shifted(now, map), kShift, 5, perPixel);
        if (level > 1) map = refined(now, map, kSimilarity, 6, perPixel);
        if (level <= 1)
            map = refined(now, map, kProjective, level > 0 ? 10 : range == SearchRange::Wide ? 6 : kNearSteps, perPixel);
        if (level > 0)
            map = scaled(map, static_cast<double>(sizeOf(level - 1).width) / sizeOf(level).width,
                         static_cast<double>(sizeOf(level - 1).height) / sizeOf(level).height);
    }
    const Comparison found(levels[0], map);
    if (found.content() < kLeastContent || found.used() <= 0) return std::nullopt;
    Normal normal;
    Step right;
    found.equations(kProjective, normal, right);
    if (found.variance() <= 0) return std::nullopt;
    normal /= kCorrelated * found.variance();
    normal += Prior(map, levels[0].seen.size(), 1).precision;
    const double sigma = sigmaOf(normal, found.contentBox());
    if (!std::isfinite(sigma)) return std::nullopt;
    return Registration{map, sigma, found.gain(), found.agreement(), found.used()};
}

double rmsMovement(const Homography& map, glm::dvec2 low, glm::dvec2 high) {
    double sum = 0;
    constexpr int kPlaces = 9;
    for (int i = 0; i < kPlaces * kPlaces; ++i) {
        const glm::dvec2 at = glm::mix(low, high, glm::dvec2(i % kPlaces, i / kPlaces) / (kPlaces - 1.0));
        const glm::dvec2 by = map(at) - at;
        sum += (by.x * by.x + by.y * by.y) / (kPlaces * kPlaces);
    }
    return std::sqrt(sum);
}

}  // namespace fantascope::vision
