#include "vision/watch/drift_track.h"

#include "core/median.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace fantascope::vision {
namespace {

constexpr Time kWindow = std::chrono::milliseconds(1200);
constexpr std::size_t kFewPlaces = 6;                  // where fewer come within the window, as from a slow camera,
constexpr Time kLongWindow = std::chrono::seconds(6);  // it is so long
constexpr std::size_t kLeastSights = 4;
constexpr double kGoodSight = 0.5;        // agreement x share of the content
constexpr double kSharpSight = 2;         // standard deviation, pixels
constexpr int kLearning = 10;             // estimates of the reference, before which nothing is said
constexpr double kUnknownSurface = 0.25;  // pixels: what a surface that was not measured may pretend
constexpr double kErrorOfComparison = 1;  // pixels
constexpr int kReferences = 100;          // estimates: twenty seconds
constexpr double kMostSpread = 3;         // of the sights about their median, pixels: more is no agreement

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
        const auto from = corners();
        for (std::size_t i = 0; i < from.size(); ++i) {
            const glm::dvec2 now = sight->shownFromPlace(from[i]);
            place.corners[2 * i] = now.x;
            place.corners[2 * i + 1] = now.y;
        }
    }
    const auto isPast = [&](const Place& place) { return place.at < at - (places_.size() > kFewPlaces ? kWindow : kLongWindow); };
    while (isPast(places_.front())) places_.pop_front();
    now_ = estimate();
    if (!now_) return;
    // Against a survey, only what is too small to be told from an error of the comparison itself
    // becomes the reference.
    if (isSurveyed_ && references_ == 0 && now_->px > kErrorOfComparison) return;
    const Homography stands = now_->moved;
    if (references_ == 0) average(stands);
    const auto compare = [&] {
        now_->moved = stands * mapTo(reference_).inverse();
        now_->px = rmsMovement(now_->moved, low_, high_);
    };
    compare();
    if (references_ < kReferences && !now_->isSure()) {
        average(stands);
        compare();
    }
    if (!isSurveyed_ && references_ < kLearning) now_.reset();
}

std::array<glm::dvec2, 4> DriftTrack::corners() const {
    return {low_, glm::dvec2(high_.x, low_.y), high_, glm::dvec2(low_.x, high_.y)};
}

Drift DriftTrack::since(const Drift& drift, const Homography& moved) const {
    Drift result = drift;
    result.moved = drift.moved * moved.inverse();
    result.px = rmsMovement(result.moved, low_, high_);
    return result;
}

// The map that takes the rectangle's corners there.
Homography DriftTrack::mapTo(const std::array<glm::dvec2, 4>& target) const {
    const auto map = Homography::fromCorners(corners(), target);
    return map ? *map : Homography();
}

// Averages the reference's corners, each sight by how sharp it is.
void DriftTrack::average(const Homography& place) {
    const double weight = 1 / (now_->sigma * now_->sigma);
    weights_ += weight;
    ++references_;
    const auto from = corners();
    for (std::size_t i = 0; i < from.size(); ++i) reference_[i] += (place(from[i]) - reference_[i]) * (weight / weights_);
}

void DriftTrack::forget() {
    places_.clear();
    references_ = 0;
    weights_ = 0;
    reference_ = {};
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
    const auto map = Homography::fromCorners(corners(), cornersOf(middle));
    if (!map) return std::nullopt;
    Drift drift;
    double sigma = 0;
    for (const Place* place : good) {
        sigma += place->sigma / static_cast<double>(good.size());
        drift.surfaceStayed += place->surfaceStayed / static_cast<double>(good.size());
    }
    if (!isSurveyed_) sigma = std::hypot(sigma, kUnknownSurface);
    drift.sigma = std::sqrt(sigma * sigma + 1.57 * spread / static_cast<double>(good.size()));
    drift.moved = *map;
    drift.px = rmsMovement(drift.moved, low_, high_);
    return drift;
}

}  // namespace fantascope::vision
