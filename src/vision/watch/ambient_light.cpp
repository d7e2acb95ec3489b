#include "vision/watch/ambient_light.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <optional>

namespace fantascope::vision {
namespace {

constexpr Eigen::Index kBase = 0, kRise = 1, kLamps = 2;  // places in the state
constexpr int kUsualFrom = 4;                             // measurements
constexpr double kLampPrior = 0.5;                        // light that nobody wonders at, of a lamp at full level
// Standard deviations.
constexpr double kReadNoise = 0.002, kShareNoise = 0.02;  // of a measurement, and of its light
constexpr double kWander = 0.0005;                        // of ambient light in a second
constexpr double kCurve = 0.5;                            // of a lamp's change of light: dimmers do not follow levels linearly
constexpr double kStrange = 3.5;                          // standard deviations from which on a measurement is strange
constexpr Time kStrangeFor = std::chrono::milliseconds(5500);     // nobody who passes takes so long
constexpr Time kStrangeBefore = std::chrono::milliseconds(2300);  // a cue

}  // namespace

struct AmbientLight::Filter {
    Eigen::VectorXd state;       // base, rise, light of each lamp at full level
    Eigen::MatrixXd covariance;  // of the state
    Eigen::VectorXd asked;       // at the last measurement
    int seen = 0;                // measurements
    std::optional<Time> last{}, strangeSince{};
    double strangeBy = 0;  // the last measurement, if that was strange

    Eigen::Index lamps() const { return asked.size(); }
    Eigen::VectorXd levelsOf(std::span<const float> levels) const {
        return Eigen::Map<const Eigen::VectorXf>(levels.data(), lamps()).cast<double>();
    }
    void foresee(std::span<const float> nowAsked, Time at);
    bool see(double light, std::span<const float> given, Time at);
};

AmbientLight::AmbientLight(std::size_t lamps) : filter_(std::make_unique<Filter>()) {
    const auto count = static_cast<Eigen::Index>(lamps);
    Filter& filter = *filter_;
    filter.state = Eigen::VectorXd::Zero(kLamps + count);
    filter.covariance = Eigen::MatrixXd::Identity(kLamps + count, kLamps + count) * kLampPrior * kLampPrior;
    filter.covariance(kBase, kBase) = 1;
    filter.covariance(kRise, kRise) = 0;
    filter.asked = Eigen::VectorXd::Zero(count);
}

AmbientLight::~AmbientLight() = default;
AmbientLight::AmbientLight(AmbientLight&&) noexcept = default;
AmbientLight& AmbientLight::operator=(AmbientLight&&) noexcept = default;

bool AmbientLight::isKnown() const { return filter_->seen >= kUsualFrom; }

AmbientLight::Light AmbientLight::rise() const {
    return {filter_->state(kRise), std::sqrt(std::max(0.0, filter_->covariance(kRise, kRise)))};
}

void AmbientLight::forgetBase() { filter_->covariance(kBase, kBase) += 1; }

bool AmbientLight::see(double light, std::span<const float> given, std::span<const float> asked, Time at) {
    filter_->foresee(asked, at);
    return filter_->see(light, given, at);
}

// What may have changed since the last measurement. What a cue changes is usual afterwards: it is
// foreseen by what is known of the lamps, but not for certain. What was strange for some time
// before counts as a rise, and what was strange for a moment may be one: afterwards it could not be
// told from the cue.
void AmbientLight::Filter::foresee(std::span<const float> nowAsked, Time at) {
    const Eigen::VectorXd change = levelsOf(nowAsked) - asked;
    asked += change;
    if (seen > 0) covariance(kBase, kBase) += kCurve * kCurve * state.tail(lamps()).cwiseProduct(change).squaredNorm();
    if (strangeSince && !change.isZero()) {
        if (at - *strangeSince >= kStrangeBefore)
            state(kRise) += strangeBy;
        else
            covariance(kRise, kRise) += strangeBy * strangeBy;
        strangeSince.reset();
    }
    if (seen >= kUsualFrom) covariance(kRise, kRise) += kWander * kWander * seconds(at - *last);
    last = at;
}

bool AmbientLight::Filter::see(double light, std::span<const float> given, Time at) {
    Eigen::VectorXd row(state.size());
    row << 1, 1, levelsOf(given);
    const double off = light - row.dot(state), noise = std::hypot(kReadNoise, kShareNoise * light);
    const auto varianceOf = [&] { return row.dot(covariance * row) + noise * noise; };
    if (seen >= kUsualFrom && off * off > kStrange * kStrange * varianceOf()) {
        if (!strangeSince || strangeBy * off < 0) strangeSince = at;
        strangeBy = off;
        if (at - *strangeSince < kStrangeFor) return false;
        covariance(kRise, kRise) += off * off;
    }
    strangeSince.reset();
    const Eigen::VectorXd reach = covariance * row;
    const double variance = varianceOf();
    state += reach * (off / variance);
    covariance -= reach * reach.transpose() / variance;
    ++seen;
    return true;
}

double AmbientLight::excessOf(double light, std::span<const float> levels) const {
    return light - filter_->state(kBase) - of(levels).mean;
}

AmbientLight::Light AmbientLight::of(std::span<const float> levels) const {
    const Eigen::Index lamps = filter_->lamps();
    const Eigen::VectorXd weights = filter_->levelsOf(levels);
    const double variance = weights.dot(filter_->covariance.bottomRightCorner(lamps, lamps) * weights);
    return {weights.dot(filter_->state.tail(lamps)), std::sqrt(std::max(0.0, variance))};
}

}  // namespace fantascope::vision
