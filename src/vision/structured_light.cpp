#include "vision/structured_light.h"

#include "core/check.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace fantascope::vision {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr double kTurn = 2 * std::numbers::pi;
// A stripe of the code: half a period, so that a code that is off by one stripe at a stripe's edge
// still names the right period.
constexpr int kStripesOfPeriod = 2;
// The least length of a period, in camera pixels and in projector pixels.
constexpr double kCameraPixelsOfPeriod = 6;
constexpr int kShortestPeriod = 16;
// A pixel is lit if its full light stands out from the noise so many times, and is this share of
// the brightest pixels'.
constexpr double kLitNoise = 8, kLitShare = 0.03, kBrightShare = 0.98;
constexpr float kSaturated = 0.999f;
// A pair is undecided where its sum differs from that of the full pair by more: as a share of the
// full light, and as a multiple of the noise.
constexpr double kMovedShare = 0.2, kMovedNoise = 5;
// A standard deviation by the median of absolute values, for normal noise.
constexpr double kDeviationOfMedian = 1.4826;
constexpr float kUnknownPhase = 0.15f;  // a sinusoid this much weaker than the full light tells nothing

float median(std::vector<float>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

int stripe(const StructuredLight& light) { return light.period() / kStripesOfPeriod; }

// Drops a pixel if most of its neighbours are farther from it than `reach`: there, the code was
// read wrongly.
Image<glm::vec2> withoutStrays(const Image<glm::vec2>& at, float reach) {
    Image<glm::vec2> kept = at;
    for (int y = 0; y < at.height(); ++y)
        for (int x = 0; x < at.width(); ++x) {
            if (std::isnan(at.at(x, y).x)) continue;
            int near = 0, far = 0;
            for (int v = std::max(0, y - 1); v <= std::min(at.height() - 1, y + 1); ++v)
                for (int u = std::max(0, x - 1); u <= std::min(at.width() - 1, x + 1); ++u)
                    if (!std::isnan(at.at(u, v).x)) ++(glm::distance(at.at(u, v), at.at(x, y)) <= reach ? near : far);
            if (near - 1 <= far) kept.at(x, y) = glm::vec2(kUnknown);  // `near` counts itself
        }
    return kept;
}

std::uint32_t grayOf(std::uint32_t number) { return number ^ (number >> 1); }
std::uint32_t numberOf(std::uint32_t gray) {
    for (int shift = 1; shift < 32; shift *= 2) gray ^= gray >> shift;
    return gray;
}

}  // namespace

StructuredLight::StructuredLight(glm::ivec2 projector, int period) : projector_(projector), period_(period) {
    FANTASCOPE_CHECK(projector.x > 1 && projector.y > 1 && period >= 2 && period % 2 == 0, "stripes of whole pixels");
    pairs_.push_back({});
    for (const Axis axis : {Axis::Across, Axis::Down}) {
        for (int bit = 0; bit < bits(axis); ++bit) pairs_.push_back({Pair::Kind::Code, axis, bit});
        for (int shift = 0; shift < kShifts / 2; ++shift) pairs_.push_back({Pair::Kind::Phase, axis, shift});
    }
}

int StructuredLight::periodFor(glm::ivec2 projector, double cameraPixels) {
    const double step =
        std::sqrt(double(projector.x) * projector.y / std::max(1.0, cameraPixels));  // projector pixels a camera pixel
    const int longest = static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(projector.x, projector.y))));
    int period = kShortestPeriod;
    while (period < kCameraPixelsOfPeriod * step && period < longest) period *= 2;
    return period;
}

int StructuredLight::bits(Axis axis) const {
    const int pixels = axis == Axis::Across ? projector_.x : projector_.y, width = period_ / kStripesOfPeriod;
    return std::bit_width(static_cast<unsigned>((pixels + width - 1) / width - 1));
}

std::size_t StructuredLight::firstPhase(Axis axis) const {
    const auto isFirst = [&](const Pair& pair) { return pair.kind == Pair::Kind::Phase && pair.axis == axis && pair.index == 0; };
    return static_cast<std::size_t>(std::ranges::find_if(pairs_, isFirst) - pairs_.begin());
}

RgbaImage StructuredLight::picture(std::size_t pair, bool complement, double gamma) const {
    const Pair& shown = pairs_.at(pair);
    const bool across = shown.axis == Axis::Across;
    std::vector<std::uint8_t> stored(static_cast<std::size_t>(across ? projector_.x : projector_.y));
    for (std::size_t i = 0; i < stored.size(); ++i) {
        double light = 1;
        if (shown.kind == Pair::Kind::Code) {
            const std::uint32_t gray =
                grayOf(static_cast<std::uint32_t>(i) / static_cast<std::uint32_t>(period_ / kStripesOfPeriod));
            light = gray >> (bits(shown.axis) - 1 - shown.index) & 1;
        } else if (shown.kind == Pair::Kind::Phase) {
            const double turns = (static_cast<double>(i) + 0.5) / period_ - double(shown.index) / kShifts;
            light = 0.5 + 0.5 * std::cos(kTurn * turns);
        }
        if (complement) light = 1 - light;
        stored[i] = static_cast<std::uint8_t>(std::lround(255 * std::pow(light, 1 / gamma)));
    }
    RgbaImage image(projector_.x, projector_.y);
    for (int y = 0; y < projector_.y; ++y)
        for (int x = 0; x < projector_.x; ++x) {
            const std::uint8_t value = stored[static_cast<std::size_t>(across ? x : y)];
            image.at(x, y) = {value, value, value, 255};
        }
    return image;
}

LightDecoder::LightDecoder(StructuredLight light, glm::ivec2 camera)
    : light_(std::move(light)), camera_(camera), lit_(camera.x, camera.y), differences_(light_.pairs().size()) {}

void LightDecoder::take(std::size_t pair, const GreyImage& picture, const GreyImage& complement) {
    for (const GreyImage* each : {&picture, &complement})
        FANTASCOPE_CHECK(each->width() == camera_.x && each->height() == camera_.y, "pictures of the camera's size");
    if (light_.pairs().at(pair).kind == StructuredLight::Pair::Kind::Full) return takeFull(picture, complement);
    FANTASCOPE_CHECK(!fulls_.empty(), "the full pair comes first");
    Difference& difference = differences_[pair];
    if (difference.value.empty()) difference.value = GreyImage(camera_.x, camera_.y, kUnknown);

    // The noise of this pair, by those pixels in which nothing moved: most of them.
    std::vector<float> errors;
    const auto errorAt = [&](std::size_t i) {
        return picture.pixels()[i] + complement.pixels()[i] - full_.pixels()[i] - dark_.pixels()[i];
    };
    for (std::size_t i = 0; i < lit_.pixels().size(); ++i)
        if (lit_.pixels()[i] != 0) errors.push_back(std::abs(errorAt(i)));
    if (errors.empty()) return;
    const double noise = std::max(noise_, kDeviationOfMedian * median(errors));
    for (std::size_t i = 0; i < lit_.pixels().size(); ++i) {
        float& value = difference.value.pixels()[i];
        if (lit_.pixels()[i] == 0 || !std::isnan(value)) continue;
        const double light = full_.pixels()[i] - dark_.pixels()[i];
        if (std::abs(errorAt(i)) > std::max(kMovedShare * light, kMovedNoise * noise)) continue;
        value = static_cast<float>((picture.pixels()[i] - complement.pixels()[i]) / light);
        ++difference.decided;
    }
}

void LightDecoder::takeFull(const GreyImage& picture, const GreyImage& complement) {
    fulls_.push_back(picture);
    darks_.push_back(complement);
    full_ = GreyImage(camera_.x, camera_.y);
    dark_ = full_;
    std::vector<float> values, deviations, lights;
    const auto medianOf = [&](const std::vector<GreyImage>& pictures, std::size_t i) {
        values.clear();
        for (const GreyImage& each : pictures) values.push_back(each.pixels()[i]);
        return median(values);
    };
    for (std::size_t i = 0; i < full_.pixels().size(); ++i) {
        full_.pixels()[i] = medianOf(fulls_, i);
        dark_.pixels()[i] = medianOf(darks_, i);
        lights.push_back(full_.pixels()[i] - dark_.pixels()[i]);
        for (const GreyImage& dark : darks_)
            if (darks_.size() > 1) deviations.push_back(std::abs(dark.pixels()[i] - dark_.pixels()[i]));
    }
    // With one picture alone, the noise is what the unlit rest of the picture differs by.
    if (deviations.empty())
        for (const float light : lights)
            if (light < 0) deviations.push_back(-light / std::numbers::sqrt2_v<float>);
    noise_ = deviations.empty() ? 0 : kDeviationOfMedian * median(deviations);

    std::vector<float> sorted = lights;
    const auto bright = sorted.begin() + static_cast<std::ptrdiff_t>(kBrightShare * static_cast<double>(sorted.size() - 1));
    std::nth_element(sorted.begin(), bright, sorted.end());
    const double least = std::max(kLitNoise * noise_, kLitShare * *bright);
    litCount_ = saturatedCount_ = 0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const bool isLit = lights[i] > least, isSaturated = full_.pixels()[i] >= kSaturated;
        lit_.pixels()[i] = isLit && !isSaturated ? 1 : 0;
        litCount_ += lit_.pixels()[i];
        saturatedCount_ += isLit && isSaturated ? 1 : 0;
    }
    for (Difference& difference : differences_) difference = {};
    differences_[0].decided = litCount_;
}

double LightDecoder::undecided(std::size_t pair) const {
    return litCount_ == 0 ? 1 : 1 - static_cast<double>(differences_.at(pair).decided) / static_cast<double>(litCount_);
}

std::vector<std::size_t> LightDecoder::litPixels() const {
    std::vector<std::size_t> pixels;
    for (std::size_t i = 0; i < lit_.pixels().size(); ++i)
        if (lit_.pixels()[i] != 0) pixels.push_back(i);
    return pixels;
}

double LightDecoder::contrast() const {
    std::vector<float> lights;
    for (const std::size_t i : litPixels()) lights.push_back(full_.pixels()[i] - dark_.pixels()[i]);
    if (lights.empty()) return 0;
    return noise_ > 0 ? median(lights) / noise_ : std::numeric_limits<double>::infinity();
}

float LightDecoder::position(StructuredLight::Axis axis, int x, int y) const {
    std::uint32_t gray = 0;
    double along = 0, across = 0;
    for (std::size_t pair = 1; pair < differences_.size(); ++pair) {
        const StructuredLight::Pair& shown = light_.pairs()[pair];
        if (shown.axis != axis) continue;
        if (differences_[pair].value.empty()) return kUnknown;
        const float value = differences_[pair].value.at(x, y);
        if (std::isnan(value)) return kUnknown;
        if (shown.kind == StructuredLight::Pair::Kind::Code) {
            gray = gray << 1 | (value > 0 ? 1 : 0);
        } else {
            const double shift = kTurn * shown.index / StructuredLight::kShifts;
            along += value * std::cos(shift);
            across += value * std::sin(shift);
        }
    }
    // The differences are cos(phase - shift); their sum over half a turn of shifts is half their
    // number.
    if (std::hypot(along, across) / (StructuredLight::kShifts / 4.0) < kUnknownPhase) return kUnknown;
    const double period = light_.period(), within = std::atan2(across, along) / kTurn * period;
    const double middle = (numberOf(gray) + 0.5) * stripe(light_);
    return static_cast<float>(within + period * std::round((middle - within) / period));
}

ProjectorMap LightDecoder::map() const {
    ProjectorMap map{Image<glm::vec2>(camera_.x, camera_.y, glm::vec2(kUnknown)), GreyImage(camera_.x, camera_.y), litCount_, 0};
    for (std::size_t i = 0; i < lit_.pixels().size(); ++i)
        if (lit_.pixels()[i] != 0) map.light.pixels()[i] = full_.pixels()[i] - dark_.pixels()[i];
    for (int y = 0; y < camera_.y; ++y)
        for (int x = 0; x < camera_.x; ++x) {
            if (lit_.at(x, y) == 0) continue;
            const glm::vec2 at(position(StructuredLight::Axis::Across, x, y), position(StructuredLight::Axis::Down, x, y));
            const glm::vec2 size(light_.projector());
            if (!(at.x > -1 && at.y > -1 && at.x < size.x + 1 && at.y < size.y + 1)) continue;
            map.at.at(x, y) = at;
        }
    map.at = withoutStrays(map.at, static_cast<float>(stripe(light_)));
    for (const glm::vec2& at : map.at.pixels()) map.known += std::isnan(at.x) ? 0 : 1;
    return map;
}

}  // namespace fantascope::vision
