#include "vision/drift_track.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace fantascope::vision {
namespace {

constexpr Time kWindow = std::chrono::seconds(1);
constexpr std::size_t kLeastSights = 5;
constexpr double kGoodSight = 0.5;  // agreement x share of the content
constexpr double kSharpSight = 2;   // standard deviation, pixels
constexpr double kMostSpread = 3;   // of the sights about their median, pixels: more is no agreement

double medianOf(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

std::array<glm::dvec2, 4> cornersOf(const std::array<double, 8>& flat) {
    return {glm::dvec2(flat[0], flat[1]), glm::dvec2(flat[2], flat[3]), glm::dvec2(flat[4], flat[5]),
            glm::dvec2(flat[6], flat[7])};
}

}  // namespace

void DriftTrack::add(Time at, const std::optional<OutputSight>& sight) {
    Place& place = places_.emplace_back();
    place.at = at;
    if (sight && sight->gain > 0 && sight->agreement * sight->used > kGoodSight && sight->sigma < kSharpSight) {
        place.isGood = true;
        place.sigma = sight->sigma;
        place.surfaceStayed = sight->surfaceStayed;
        const auto corners = rectangleCorners(projector_.x, projector_.y);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const glm::dvec2 now = sight->shownFromPlace(corners[i]);
            place.corners[2 * i] = now.x;
            place.corners[2 * i + 1] = now.y;
        }
    }
    while (places_.front().at < at - kWindow) places_.pop_front();
    now_ = estimate();
    if (isSurveyed_ || !now_) return;
    if (!reference_) reference_ = now_->moved;
    now_->moved = now_->moved * reference_->inverse();
    now_->px = rmsMovement(now_->moved, projector_);
}

void DriftTrack::forget() {
    places_.clear();
    reference_.reset();
    now_.reset();
    isSurveyed_ = false;
}

std::optional<Drift> DriftTrack::estimate() const {
    std::vector<const Place*> good;
    for (const Place& place : places_)
        if (place.isGood) good.push_back(&place);
    if (good.size() < kLeastSights || 2 * good.size() < places_.size()) return std::nullopt;
    std::array<double, 8> middle{};
    double spread = 0;
    for (std::size_t i = 0; i < middle.size(); ++i) {
        std::vector<double> values;
        for (const Place* place : good) values.push_back(place->corners[i]);
        middle[i] = medianOf(values);
        for (double& value : values) value = std::abs(value - middle[i]);
        const double deviation = 1.4826 * medianOf(values);
        spread += deviation * deviation / 4;  // two coordinates of a point, four points
    }
    if (std::sqrt(spread) > kMostSpread) return std::nullopt;
    const auto map = Homography::fromCorners(rectangleCorners(projector_.x, projector_.y), cornersOf(middle));
    if (!map) return std::nullopt;
    Drift drift;
    double sigma = 0;
    for (const Place* place : good) {
        sigma += place->sigma / static_cast<double>(good.size());
        drift.surfaceStayed += place->surfaceStayed / static_cast<double>(good.size());
    }
    drift.sigma = std::sqrt(sigma * sigma + 1.57 * spread / static_cast<double>(good.size()));
    drift.moved = *map;
    drift.px = rmsMovement(drift.moved, projector_);
    return drift;
}

}  // namespace fantascope::vision
