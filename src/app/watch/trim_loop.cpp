#include "app/watch/trim_loop.h"

#include <algorithm>
#include <cmath>

namespace fantascope::app {
namespace {

constexpr Time kDecides = std::chrono::milliseconds(2300);
constexpr double kGain = 0.4;        // share of the excess that one decision takes away
constexpr double kDeadBand = 0.006;  // of full light,
constexpr double kDeadShare = 0.03;  // and of the other light
constexpr double kMostUnsure = 2;    // dead bands: an uncertainty that matters
constexpr double kNearEnough = 0.3;  // of the dead band: a movement ends there
constexpr double kLeastStep = 0.01;  // of the share
constexpr double kAtLimit = 0.02;    // of the share
constexpr double kTooMuch = 0.1;     // of the rise: what a relay may take away beyond what is missed
constexpr double kBetter = 0.75;     // of what is missed: a relay that leaves less comes on again
constexpr Time kRelayPatience = std::chrono::seconds(10);

// The excess that is left, whatever the fixtures do: none if it lies between what they leave at
// their least and at their full share.
struct Reach {
    double low = 0, high = 0;
    double missed(double more = 0) const { return std::max({0.0, low + more, -(high + more)}); }
};

// The most light that a relay's lamp may give: no more than there is other light on a usual night
// beside that of the fixtures.
double mostOf(const TrimSight::Light& relay, const TrimSight& sight) {
    const double usual = sight.total - sight.excess, fixtures = std::max(0.0, sight.fixtures.mean - 2 * sight.fixtures.sigma);
    return std::min(relay.most(), std::max(0.0, usual - fixtures));
}

}  // namespace

double TrimLoop::deadBandOf(const TrimSight& sight) { return std::max(kDeadBand, kDeadShare * sight.total); }

bool TrimLoop::isWorthIt(const TrimSight& sight) { return sight.full.mean + sight.full.sigma > deadBandOf(sight); }

show::LampTrim TrimLoop::step(const TrimSight& sight, const show::LampTrim& goal) {
    if (decided_ && sight.at - *decided_ < kDecides) return goal;
    decided_ = sight.at;
    return {static_cast<float>(shareFor(sight, goal.share)), goal.relaysOff + relayStep(sight)};
}

double TrimLoop::shareFor(const TrimSight& sight, double goal) {
    if (!isWorthIt(sight)) return 1;
    const double band = deadBandOf(sight), ahead = goal - sight.share;
    const double most = std::max(band / 2, std::min(sight.total, sight.fixtures.most()));
    // A trim ends if the full share would leave no excess, or if the rise is within its
    // uncertainty. For such a rise none begins.
    const double unsure = std::min(sight.ambient.sigma, kMostUnsure * band);
    if (sight.excess + (1 - sight.share) * most <= band / 2 || sight.ambient.mean <= (goal < 1 ? band / 2 : band) + unsure)
        return 1;
    const bool matters = sight.fixtures.most() > band / 2;  // else the cue has darkened them
    moves_ = matters && std::abs(sight.excess) > (moves_ ? kNearEnough * band : band);
    if (!moves_) return std::abs(ahead) > kLeastStep ? sight.share : goal;
    const double wanted = std::clamp(sight.share - kGain * sight.excess / most, bounds_.least, 1.0);
    const double further = wanted - sight.share, onTheWay = 2 * bounds_.speed * seconds(kDecides);
    if (ahead * further > 0 && std::min(std::abs(ahead), std::abs(further)) > onTheWay) return goal;
    const bool isLast = wanted == bounds_.least || wanted == 1;
    return std::abs(wanted - goal) < kLeastStep && !isLast ? goal : wanted;
}

// One more or one less that should be off, once that has lasted. A relay is switched off only if
// its lamp takes away no more than what is missed, however much light it gives.
int TrimLoop::relayStep(const TrimSight& sight) {
    const double light = std::max(0.0, sight.fixtures.mean), band = deadBandOf(sight);
    const Reach reach{sight.excess + (bounds_.least - sight.share) * light, sight.excess + (1 - sight.share) * light};
    const bool isAtLimit = sight.share <= bounds_.least + kAtLimit || !isWorthIt(sight);
    int wish = 0;
    if (sight.next && isAtLimit && reach.low > band && mostOf(*sight.next, sight) <= reach.low + kTooMuch * sight.ambient.mean) {
        wish = 1;
    } else if (sight.last) {
        const double missed = reach.missed(), left = reach.missed(sight.last->mean);
        if (left <= band / 2 || (missed > band && left < kBetter * missed)) wish = -1;
    }
    if (!sight.maySwitch) wish = 0;
    if (wish != wish_) wishedSince_ = sight.at;
    wish_ = wish;
    if (wish == 0 || sight.at - wishedSince_ < kRelayPatience) return 0;
    wish_ = 0;
    return wish;
}

}  // namespace fantascope::app
