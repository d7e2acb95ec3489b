#include "vision/watch/surroundings.h"

#include "core/median.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::vision {
namespace {

constexpr int kPatch = 16;  // side of a patch, camera pixels
constexpr std::size_t kLeastPatches = 8;
constexpr double kDarkest = 1e-5;  // linear light
constexpr double kLeastGain = 0.05;
constexpr double kLeastOwn = 0.5;  // of the spread: so much of it at least is no noise
constexpr int kUsualAfter = 2;     // pictures

// The mean light of every patch that counts as a whole; negative: it does not.
std::vector<double> patchesOf(const GreyImage& seen, const GreyImage& mask) {
    std::vector<double> patches;
    for (int top = 0; top + kPatch <= seen.height(); top += kPatch)
        for (int left = 0; left + kPatch <= seen.width(); left += kPatch) {
            double sum = 0;
            int count = 0;
            for (int y = top; y < top + kPatch; ++y)
                for (int x = left; x < left + kPatch; ++x)
                    if (mask.at(x, y) > 0) sum += seen.at(x, y) < 0 ? 1 : seen.at(x, y), ++count;
            patches.push_back(count == kPatch * kPatch ? sum / count : -1);
        }
    return patches;
}

}  // namespace

void Surroundings::lampsChange(const std::optional<LampState>& state) {
    if (!isLearning()) kept_ = now_;
    usual_.change(state, !isLearning());
}

bool Surroundings::isLearning() const { return usual_->pictures < kUsualAfter; }

void Surroundings::learn(const std::vector<double>& now) {
    if (usual_->pictures == 0) usual_->light.assign(now.size(), -1);
    const double share = 1.0 / ++usual_->pictures;
    std::vector<double> squares;  // of differences between this picture and those before
    for (std::size_t i = 0; i < now.size(); ++i) {
        if (now[i] < 0) continue;
        const double usual = std::max(0.0, now[i] - kept_.veil) / std::max(kept_.gain, kLeastGain),
                     off = usual - usual_->light[i];
        if (usual_->light[i] >= 0) squares.push_back(off * off);
        usual_->light[i] = usual_->light[i] < 0 ? usual : usual_->light[i] + share * off;
    }
    // The difference of two pictures has twice the variance of one, and four times that of their
    // mean. The median of its square is 0.455 of its variance.
    if (!squares.empty()) usual_->noise = medianOf(squares) / 0.455 / 4;
}

std::optional<SurroundingsLight> Surroundings::measure(const GreyImage& seen) {
    const std::vector<double> now = patchesOf(seen, mask_);
    if (isLearning()) {
        learn(now);
        return std::nullopt;
    }
    std::vector<std::pair<double, double>> patches;  // usual, now
    for (std::size_t i = 0; i < now.size(); ++i)
        if (usual_->light[i] >= 0) patches.emplace_back(usual_->light[i], now[i]);
    if (patches.size() < kLeastPatches) return std::nullopt;
    // A straight line through most patches: now = gain x usual + veil. Patches that somebody hides,
    // or a headlight lights, count less and less.
    std::vector<double> ratios, differences;
    for (const auto& [x, y] : patches) ratios.push_back(y / std::max(x, kDarkest)), differences.push_back(y - x);
    const auto missOf = [&](const SurroundingsLight& guess) {
        std::vector<double> left;
        for (const auto& [x, y] : patches) left.push_back(std::abs(y - guess.gain * x - guess.veil));
        return medianOf(left);
    };
    const SurroundingsLight changed{.gain = medianOf(ratios)}, veiled{.veil = medianOf(differences)};
    SurroundingsLight light = missOf(changed) <= missOf(veiled) ? changed : veiled;
    for (int turn = 0; turn < 5; ++turn) {
        const double cut = 4.685 * 1.4826 * std::max(missOf(light), kDarkest);
        double count = 0, x = 0, y = 0, xx = 0, xy = 0;
        for (const auto& [usual, seen] : patches) {
            const double share = (seen - light.gain * usual - light.veil) / cut, keep = std::max(0.0, 1 - share * share),
                         weight = keep * keep;
            count += weight;
            x += weight * usual;
            y += weight * seen;
            xx += weight * usual * usual;
            xy += weight * usual * seen;
        }
        const double mean = x / count, level = y / count;
        // The camera's noise adds to the spread of what is usual, which would make every line too
        // flat. Where all patches are alike, a line says nothing, and the gain explains all.
        const double spread = xx / count - mean * mean, flat = 0.001 * mean * mean + 1e-10;
        const double own = std::max(spread - usual_->noise, kLeastOwn * spread), ratio = level / std::max(mean, kDarkest);
        light.gain = (xy / count - mean * level + flat * ratio) / (own + flat);
        light.level = ratio;
        light.veil = level - light.gain * mean;
    }
    now_ = light;
    return light;
}

}  // namespace fantascope::vision
