#include "vision/watch/light_meter.h"

#include "core/median.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace fantascope::vision {
namespace {

constexpr int kBlocks = 32;                    // at least, unless blocks would be too small
constexpr int kLeastSide = 8, kMostSide = 16;  // of a block, cells
constexpr std::size_t kLeastBlocks = 12;       // that tell something
constexpr int kLearning = 6;                   // pictures, from which the usual picture is known
constexpr int kLearningLight = 3;              // pictures, from which the usual other light is known
constexpr int kLasting = 5;                    // measurements: nobody who passes hides a block for so long
constexpr double kTells = 0.05;                // a block tells something if its light varies so much, as a share of full light
constexpr double kUnexplained = 0.3;           // of the picture's variance: what is left of a block that is explained
constexpr double kOutlier = 0.5;               // and from which on it has no weight
constexpr double kLeastOther = 0.005;          // of full light: other light whose texture can be told
constexpr double kThere = 0.6;                 // a picture is there if it leaves less than this share of what no picture leaves
constexpr double kPartThere = 0.1;             // or if so much of it is as usual
constexpr double kCameraBlurs = 0.8;           // and the camera blurs, if that leaves less than this share
constexpr std::array<double, 9> kBlurs{0, 0.5, 0.8, 1.2, 1.8, 2.7, 4, 6, 9};  // cells

// How strong the picture is on the wall, and how much other light shows the surface's texture, as a
// share of full light.
struct Strengths {
    double contrast = 0, texture = 0;
};

// A part of the picture: the light that is seen, and the picture's light as it is expected.
struct Block {
    bool isWhole = false;                                // most of its cells count
    double seen = 0, shown = 0, full = 0;                // means
    double seenSeen = 0, seenShown = 0, shownShown = 0;  // variances and covariance,
    double seenFull = 0, shownFull = 0, fullFull = 0;    // those with the surface's texture, too
    // What is left of the variance.
    double left(const Strengths& by) const {
        return std::max(0.0, seenSeen - 2 * (by.contrast * seenShown + by.texture * seenFull) +
                                 by.contrast * by.contrast * shownShown + 2 * by.contrast * by.texture * shownFull +
                                 by.texture * by.texture * fullFull);
    }
};
using Blocks = std::vector<Block>;

cv::Mat viewOf(const GreyImage& image) {
    return {image.height(), image.width(), CV_32F, const_cast<float*>(image.pixels().data())};
}

cv::Mat blurredBy(const cv::Mat& image, double sigma) {
    if (sigma <= 0) return image;
    cv::Mat soft;
    cv::GaussianBlur(image, soft, {}, sigma, sigma, cv::BORDER_REPLICATE);
    return soft;
}

// Cells along a block's side. Where a picture is small, blocks of many cells would each be too much
// of it.
int sideOf(const GreyImage& picture) {
    const double cells = static_cast<double>(picture.width()) * picture.height();
    return std::clamp(static_cast<int>(std::sqrt(cells / kBlocks)), kLeastSide, kMostSide);
}

// `lit`: the picture's light on the surface, as the camera gets it. `side`: of a block.
Block blockOf(const LightMeter::Sight& sight, const cv::Mat& lit, int side, int left, int top) {
    Block block;
    int cells = 0;
    for (int y = top; y < std::min(top + side, lit.rows); ++y)
        for (int x = left; x < std::min(left + side, lit.cols); ++x) {
            const double full = sight.surface.at(x, y), seen = sight.seen.at(x, y), shown = lit.at<float>(y, x);
            if (full <= 0 || sight.mask.at(x, y) <= 0) continue;
            ++cells;
            block.seen += seen;
            block.shown += shown;
            block.full += full;
            block.seenSeen += seen * seen;
            block.seenShown += seen * shown;
            block.shownShown += shown * shown;
            block.seenFull += seen * full;
            block.shownFull += shown * full;
            block.fullFull += full * full;
        }
    block.isWhole = cells >= side * side / 2;
    const double count = std::max(1, cells);
    for (double* sum : {&block.seen, &block.shown, &block.full, &block.seenSeen, &block.seenShown, &block.shownShown,
                        &block.seenFull, &block.shownFull, &block.fullFull})
        *sum /= count;
    block.seenSeen -= block.seen * block.seen;
    block.seenShown -= block.seen * block.shown;
    block.shownShown -= block.shown * block.shown;
    block.seenFull -= block.seen * block.full;
    block.shownFull -= block.shown * block.full;
    block.fullFull -= block.full * block.full;
    return block;
}

Blocks blocksOf(const LightMeter::Sight& sight, const cv::Mat& lit) {
    Blocks blocks;
    const int side = sideOf(sight.surface);
    for (int top = 0; top < lit.rows; top += side)
        for (int left = 0; left < lit.cols; left += side) blocks.push_back(blockOf(sight, lit, side, left, top));
    return blocks;
}

// How well strengths explain blocks.
struct Fit {
    Strengths by;
    double loss = std::numeric_limits<double>::max();  // mean over the blocks, 0..1
};

// Compares strengths on the blocks that tell something.
class Telling {
public:
    // `scale`: by block: the variance of its picture on the wall at the usual contrast; 0: it tells
    // nothing.
    Telling(std::vector<double> scale, double usual) : scale_(std::move(scale)), usual_(usual) {
        for (std::size_t i = 0; i < scale_.size(); ++i)
            if (scale_[i] > 0) which_.push_back(i);
    }
    const std::vector<std::size_t>& which() const { return which_; }

    // What strengths leave of a block's variance, as a share of what is usual there, or of what is
    // seen if that is more.
    double shareLeft(const Blocks& blocks, std::size_t i, const Strengths& by) const {
        return blocks[i].left(by) / std::max(scale_[i], blocks[i].seenSeen);
    }
    double lossOf(const Blocks& blocks, const Strengths& by) const {
        double sum = 0;
        for (const std::size_t i : which_) sum += std::min(1.0, shareLeft(blocks, i, by) / kOutlier);
        return sum / static_cast<double>(which_.size());
    }
    double shareExplained(const Blocks& blocks, const Strengths& by) const {
        const auto count = std::ranges::count_if(which_, [&](std::size_t i) { return shareLeft(blocks, i, by) < kUnexplained; });
        return static_cast<double>(count) / static_cast<double>(which_.size());
    }
    // The strengths that explain most blocks. They are found from two guesses (Tukey's biweight).
    Fit best(const Blocks& blocks) const {
        Fit best;
        for (const Strengths& guess : {Strengths{usual_, 0}, plain(blocks)}) {
            Strengths by = guess;
            for (int turn = 0; turn < 5; ++turn)
                by = strengthsOf(blocks, [&](std::size_t i) {
                    const double keep = std::max(0.0, 1 - shareLeft(blocks, i, by) / kOutlier);
                    return keep * keep;
                });
            const double loss = lossOf(blocks, by);
            if (loss < best.loss) best = {by, loss};
        }
        return best;
    }
    // Those that explain all blocks together best.
    Strengths plain(const Blocks& blocks) const {
        return strengthsOf(blocks, [](std::size_t) { return 1.0; });
    }

private:
    // Least squares.
    Strengths strengthsOf(const Blocks& blocks, const auto& weightOf) const {
        constexpr double kFlat = 1e-3;  // (of full light) squared: a surface without texture tells no other light
        double seenShown = 0, seenFull = 0, shownShown = 0, shownFull = 0, fullFull = 0;
        for (const std::size_t i : which_) {
            const Block& block = blocks[i];
            const double weight = weightOf(i) / scale_[i];
            seenShown += weight * block.seenShown;
            seenFull += weight * block.seenFull;
            shownShown += weight * block.shownShown;
            shownFull += weight * block.shownFull;
            fullFull += weight * (block.fullFull + kFlat * block.full * block.full);
        }
        const double determinant = shownShown * fullFull - shownFull * shownFull;
        if (determinant <= 0) return {};
        const Strengths by{(seenShown * fullFull - seenFull * shownFull) / determinant,
                           (seenFull * shownShown - seenShown * shownFull) / determinant};
        return by.contrast > 0 ? by : Strengths{0, seenFull / fullFull};
    }

    std::vector<double> scale_;
    double usual_;
    std::vector<std::size_t> which_;
};

// The other light on most of the picture, as a share of full light.
double otherLightOf(const Blocks& blocks, double contrast) {
    std::vector<double> shares;
    for (const Block& block : blocks)
        if (block.isWhole) shares.push_back((block.seen - contrast * block.shown) / block.full);
    return shares.empty() ? 0 : medianOf(std::move(shares));
}

// The share of the picture's bright places that the camera cannot tell.
double saturatedShare(const LightMeter::Sight& sight, const cv::Mat& shown) {
    constexpr float kBright = 0.5f;
    int bright = 0, saturated = 0;
    for (int y = 0; y < shown.rows; ++y)
        for (int x = 0; x < shown.cols; ++x) {
            if (sight.surface.at(x, y) <= 0 || shown.at<float>(y, x) < kBright) continue;
            ++bright;
            saturated += sight.mask.at(x, y) <= 0 ? 1 : 0;
        }
    return bright > 0 ? static_cast<double>(saturated) / bright : 0;
}

std::size_t nearestBlur(double blur) {
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < kBlurs.size(); ++i)
        if (std::abs(kBlurs[i] - blur) < std::abs(kBlurs[nearest] - blur)) nearest = i;
    return nearest;
}

// The blur about kBlurs[best] at which a parabola through the losses is least, and the contrast
// there.
struct Between {
    double blur = 0, contrast = 0;
};
Between leastBetween(const std::array<Fit, kBlurs.size()>& fits, std::size_t best) {
    if (best == 0 || best + 1 == kBlurs.size()) return {kBlurs[best], fits[best].by.contrast};
    const double before = fits[best - 1].loss, here = fits[best].loss, after = fits[best + 1].loss,
                 bend = before - 2 * here + after;
    const double step = bend > 0 ? std::clamp((before - after) / (2 * bend), -0.5, 0.5) : 0;
    const std::size_t towards = step > 0 ? best + 1 : best - 1;
    return {std::lerp(kBlurs[best], kBlurs[towards], std::abs(step)),
            std::lerp(fits[best].by.contrast, fits[towards].by.contrast, std::abs(step))};
}

}  // namespace

GreyImage placedLight(const GreyImage& light, const Homography& shownFromPlace) {
    cv::Mat x(light.height(), light.width(), CV_32F), y(light.height(), light.width(), CV_32F);
    for (int row = 0; row < x.rows; ++row)
        for (int column = 0; column < x.cols; ++column) {
            const glm::dvec2 at = shownFromPlace({column + 0.5, row + 0.5});
            x.at<float>(row, column) = static_cast<float>(at.x - 0.5);
            y.at<float>(row, column) = static_cast<float>(at.y - 0.5);
        }
    GreyImage placed(light.width(), light.height());
    cv::Mat out = viewOf(placed);
    cv::remap(viewOf(light), out, x, y, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
    return placed;
}

void LightMeter::lampsChange(const std::optional<LampState>& state) {
    const bool isLearned = usualOther_->pictures >= kLearningLight;
    if (isLearned) keptOther_ = other_;
    usualOther_.change(state, isLearned);
}

// What a sight shows at every blur, and which blur and strengths explain it.
struct LightMeter::Comparison {
    GreyImage placed;  // the frame's light
    cv::Mat shown = viewOf(placed);
    std::array<Blocks, kBlurs.size()> blocks{};
    Telling telling;
    std::size_t usualBlur = 0, bestBlur = 0;  // indices into kBlurs
    double contrast = 0, blur = 0;            // contrast 0: the picture is not there
    Strengths explaining{};                   // at the best of kBlurs
    double loss = 1;
    double otherLight = 0;

    bool isUsual(std::size_t block, const Usual& usual) const {
        return telling.shareLeft(blocks[usualBlur], block, {usual.contrast, explaining.texture}) < mostLeft(block, usual);
    }
    bool isExplained(std::size_t block, const Usual& usual) const {
        return telling.shareLeft(blocks[bestBlur], block, explaining) < mostLeft(block, usual);
    }

private:
    static double mostLeft(std::size_t block, const Usual& usual) { return std::max(kUnexplained, 3 * usual.unexplained[block]); }
};

LightMeter::Comparison LightMeter::compare(const Sight& sight) const {
    Comparison now{.placed = placedLight(sight.light, sight.shownFromPlace), .telling = Telling({}, 1)};
    const cv::Mat surface = viewOf(sight.surface);
    for (std::size_t i = 0; i < kBlurs.size(); ++i) now.blocks[i] = blocksOf(sight, blurredBy(now.shown, kBlurs[i]).mul(surface));
    now.usualBlur = now.bestBlur = nearestBlur(usual_.blur);
    std::vector<double> scale(now.blocks[0].size(), 0);
    for (std::size_t i = 0; i < scale.size(); ++i) {
        const Block& sharp = now.blocks[0][i];
        const bool isStrange = usual_.pictures >= kLearning && usual_.unexplained[i] >= kUnexplained;
        if (sharp.isWhole && sharp.shownShown > kTells * kTells * sharp.full * sharp.full && !isStrange)
            scale[i] = now.blocks[now.usualBlur][i].shownShown;
    }
    double usual = usual_.contrast;
    if (usual_.pictures == 0) usual = Telling(scale, 1).plain(now.blocks[0]).contrast;
    for (double& variance : scale) variance *= usual * usual;
    now.telling = Telling(std::move(scale), usual);
    if (now.telling.which().size() < kLeastBlocks) return now;

    std::array<Fit, kBlurs.size()> fits;
    for (std::size_t i = 0; i < kBlurs.size(); ++i) fits[i] = now.telling.best(now.blocks[i]);
    now.bestBlur = static_cast<std::size_t>(std::ranges::min_element(fits, {}, &Fit::loss) - fits.begin());
    now.loss = fits[now.bestBlur].loss;
    const Between between = leastBetween(fits, now.bestBlur);
    now.blur = between.blur;
    const bool isThere =
        now.loss < kThere * now.telling.lossOf(now.blocks[now.bestBlur], {0, fits[now.bestBlur].by.texture}) ||
        now.telling.shareExplained(now.blocks[now.usualBlur], {usual, fits[now.bestBlur].by.texture}) > kPartThere;
    now.contrast = isThere ? between.contrast : 0;
    now.explaining = {isThere ? fits[now.bestBlur].by.contrast : 0, fits[now.bestBlur].by.texture};
    now.otherLight = otherLightOf(now.blocks[now.bestBlur], now.contrast);
    return now;
}

void LightMeter::learn(const Comparison& now) {
    if (usualOther_->pictures < kLearningLight)
        usualOther_->light += (now.otherLight - keptOther_ - usualOther_->light) / ++usualOther_->pictures;
    if (usual_.pictures >= kLearning || now.contrast <= 0) return;
    const double share = 1.0 / ++usual_.pictures;  // so that the usual is the mean
    usual_.contrast += share * (now.contrast - usual_.contrast);
    usual_.blur += share * (now.blur - usual_.blur);
    for (const std::size_t i : now.telling.which()) {
        double& unexplained = usual_.unexplained[i];
        const double left = now.telling.shareLeft(now.blocks[now.bestBlur], i, now.explaining);
        unexplained = unexplained < 0 ? left : unexplained + share * (left - unexplained);
    }
}

OutputLight LightMeter::describe(const Comparison& now, const Sight& sight) {
    OutputLight light;
    light.contrast = now.contrast / usual_.contrast;
    light.saturated = saturatedShare(sight, now.shown);
    light.allOtherLight = now.otherLight;
    if (now.otherLight > kLeastOther) light.textured = std::clamp(now.explaining.texture / now.otherLight, 0.0, 1.0);
    light.otherLight = usualOther_->pictures >= kLearningLight ? other_ : keptOther_;
    if (now.contrast > 0 && now.blur > usual_.blur) {
        light.blur = std::sqrt(now.blur * now.blur - usual_.blur * usual_.blur);
        const Blocks byCamera = blocksOf(sight, blurredBy(now.shown.mul(viewOf(sight.surface)), kBlurs[now.bestBlur]));
        light.isCameraBlurred = now.telling.best(byCamera).loss < kCameraBlurs * now.loss;
    }
    double asUsual = 0, explained = 0, hidden = 0;
    for (const std::size_t i : now.telling.which()) {
        const bool isUsual = now.isUsual(i, usual_);
        off_[i] = isUsual ? 0 : off_[i] + 1;
        asUsual += isUsual ? 1 : 0;
        explained += now.isExplained(i, usual_) ? 1 : 0;
        hidden += off_[i] >= kLasting ? 1 : 0;
    }
    const double count = static_cast<double>(now.telling.which().size());
    light.asUsual = asUsual / count;
    light.explained = explained / count;
    light.hidden = hidden / count;
    return light;
}

std::optional<OutputLight> LightMeter::measure(const Sight& sight, bool isFound) {
    const Comparison now = compare(sight);
    if (now.telling.which().size() < kLeastBlocks) return std::nullopt;
    const bool isKnown = usual_.pictures >= kLearning;
    usual_.unexplained.resize(now.blocks[0].size(), -1);
    off_.resize(now.blocks[0].size());
    if (isFound) learn(now);
    other_ = now.otherLight - usualOther_->light;
    return isKnown ? std::optional(describe(now, sight)) : std::nullopt;
}

}  // namespace fantascope::vision
