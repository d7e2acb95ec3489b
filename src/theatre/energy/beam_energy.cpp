#include "theatre/energy/beam_energy.h"

#include "theatre/energy/energy_terms.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope::theatre {
namespace {

constexpr double kEnds = 0.25;  // share of a capsule's width that its round ends add to its length; the rest overlaps the next

// The approximate area of a body's shadow beside or above the frame, in pixels. A capsule's shadow
// is as long as its axis's and as wide as the mean of its ends. The part whose axis is outside
// counts, weighted more the farther out it is.
double areaBeyond(const ScreenFrame& frame, const PosedBody& body) {
    const double width = frame.width();
    double area = 0;
    for (const PlacedCapsule& capsule : body.capsules()) {
        const glm::dvec3 from = frame.fromLight(capsule.from), to = frame.fromLight(capsule.to);
        if (from.z <= 0 || to.z <= 0) continue;  // no bounded shadow
        const glm::dvec2 a = frame.foot() + frame.focus() / from.z * glm::dvec2(from),
                         b = frame.foot() + frame.focus() / to.z * glm::dvec2(to);
        // The part [first, last] of the axis that is inside.
        double first = 0, last = 1, far = 0;
        const auto cut = [&](double atFirst, double atLast) {  // distances inside an edge
            far = std::max({far, -atFirst, -atLast});
            if (atFirst < 0 && atLast < 0) last = first;
            if (atFirst < 0 && atLast >= 0) first = std::max(first, atFirst / (atFirst - atLast));
            if (atFirst >= 0 && atLast < 0) last = std::min(last, atFirst / (atFirst - atLast));
        };
        cut(a.x, b.x);
        cut(width - a.x, width - b.x);
        cut(a.y, b.y);
        if (far <= 0) continue;
        const double outside = 1 - std::max(0.0, last - first);
        const double across = frame.focus() * (capsule.fromRadius / from.z + capsule.toRadius / to.z);
        area += outside * across * (glm::distance(a, b) + kEnds * across) * (1 + far / width);
    }
    return area;
}

}  // namespace

BeamEnergy::BeamEnergy(const PoseProblem& problem, std::size_t beam, std::span<const PlacedProp> standing)
    : problem_(problem),
      target_(problem.targets[beam]),
      disc_(std::max(1.0, kDiscRadius / target_.refPixelsPerPixel)),
      actors_(problem.actors.size()) {
    shadow_ = shadowBefore_ = BitMask(target_.mask.width(), target_.mask.height());
    for (Actor& actor : actors_) actor.shadow = shadow_;
    if (!standing.empty() || !problem.stage.platforms.empty()) standingShadow_ = shadow_;
    for (const Stage::Platform& platform : problem.stage.platforms) addShadow(target_.frame, meshOf(platform), standingShadow_);
    for (const PlacedProp& prop : standing) addShadow(target_.frame, meshOf(prop), standingShadow_);
    target_.cut(problem.stage, standingShadow_);
    nearest_.resize(target_.contour.size());
    owners_.resize(nearest_.size());
}

void BeamEnergy::pose(std::size_t index, const PosedBody& body, std::span<const glm::vec3> skin,
                      std::span<const PlacedProp> held) {
    Actor& actor = actors_[index];
    actor.shadow.clear();
    if (problem_.skins.empty())
        capsuleShadow_.add(target_.frame, body, actor.shadow);
    else
        meshShadow_.add(target_.frame, *problem_.skins[index], skin, actor.shadow);
    target_.cut(problem_.stage, actor.shadow);
    if (!problem_.stage.beams[target_.beam].lit) actor.beyond = areaBeyond(target_.frame, body);
    if (held.empty()) return;
    if (actor.held.width() == 0) actor.held = BitMask(shadow_.width(), shadow_.height());
    actor.held.clear();
    for (const PlacedProp& prop : held) addShadow(target_.frame, meshOf(prop), actor.held);
    target_.cut(problem_.stage, actor.held);
}

void BeamEnergy::addTo(EnergyTerms& terms) {
    std::swap(shadow_, shadowBefore_);
    shadow_.clear();
    if (standingShadow_.width() > 0) shadow_.add(standingShadow_);
    for (const Actor& actor : actors_) {
        shadow_.add(actor.shadow);
        if (actor.held.width() > 0) shadow_.add(actor.held);
    }
    terms.coverage += (static_cast<double>(differing(shadow_, target_.mask)) + beyond()) / target_.area;
    compareContours(terms);
    terms.coherence += ownerChanges(owners_);
}

double BeamEnergy::beyond() const {
    double sum = 0;
    for (const Actor& actor : actors_) sum += actor.beyond;
    return sum;
}

BitMask BeamEnergy::propShadow() const {
    BitMask shadow(shadow_.width(), shadow_.height());
    if (standingShadow_.width() > 0) shadow.add(standingShadow_);
    for (const Actor& actor : actors_)
        if (actor.held.width() > 0) shadow.add(actor.held);
    return shadow;
}

// Whether the cached nearest point of a target's point is still valid. No contour pixel at most as
// far away may have appeared or vanished, which takes a change of the pixel or of a neighbour. And
// the disc in which the nearest point is measured must be unchanged.
bool BeamEnergy::isAsBefore(std::size_t point) const {
    if (!hasNearest_) return false;
    if (!changes_.isAny()) return true;
    const glm::ivec2 wanted = target_.contour[point].pixel, got = nearest_[point].pixel;
    const int away = static_cast<int>(std::ceil(glm::distance(glm::dvec2(wanted), glm::dvec2(got))));
    return !changes_.mayReach(wanted, away + 1) && !changes_.mayReach(got, disc_.radius());
}

// Equation 2, from the target's contour to the nearest points of the shadow's contour. Also their
// owners, for equation 4: the actor whose shadow contains the point. Of several actors it is the
// previous point's owner, or else the first. A point in nobody's shadow is a prop's.
void BeamEnergy::compareContours(EnergyTerms& terms) {
    const PoseTarget& target = target_;
    const double scale = target.refPixelsPerPixel * target.refPixelsPerPixel, each = target.perPoint();
    changes_.find(shadow_, shadowBefore_);
    if (changes_.isAny() || !hasNearest_) contour_.find(shadow_);
    int owner = 0;
    std::optional<glm::ivec2> pixel;
    for (std::size_t i = 0; i < target.contour.size(); ++i) {
        const ContourPoint& wanted = target.contour[i];
        if (isAsBefore(i)) {
            pixel = nearest_[i].pixel;
        } else if ((pixel = contour_.nearest(wanted.pixel, pixel))) {
            nearest_[i] = disc_.at(shadow_, *pixel);
        } else {
            // Without any shadow the distance is the width of the mask.
            terms.contourPoint += each * scale * target.mask.width() * target.mask.width();
            nearest_[i] = {};
        }
        if (pixel) {
            const ContourPoint& got = nearest_[i];
            const glm::dvec2 away = wanted.pixel - got.pixel, turned = wanted.normal - got.normal;
            const double bent = wanted.curvature - got.curvature;
            terms.contourPoint += each * scale * glm::dot(away, away);
            terms.contourNormal += each * glm::dot(turned, turned);
            terms.contourCurvature += each * bent * bent;
            if (owner == kNobody || !actors_[static_cast<std::size_t>(owner)].shadow.at(pixel->x, pixel->y)) {
                const auto found = std::find_if(actors_.begin(), actors_.end(),
                                                [&](const Actor& actor) { return actor.shadow.at(pixel->x, pixel->y); });
                owner = found == actors_.end() ? kNobody : static_cast<int>(found - actors_.begin());
            }
        }
        owners_[i] = owner;
    }
    hasNearest_ = pixel.has_value();
}

}  // namespace fantascope::theatre
