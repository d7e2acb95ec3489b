#include "theatre/silhouette_fit.h"

#include "theatre/distance_field.h"
#include "theatre/energy_terms.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace fantascope::theatre {
namespace {

// Of the shadow's contour so many points at most are asked where they should be.
constexpr int kShadowPoints = 500;
// No point is asked to go farther at once, pixels: beyond it the derivative says nothing.
constexpr double kFarthest = 12;
// A hole's edge lies deep in the target: it is asked to go as far as this.
constexpr double kIntoHole = 6;
// Residuals nearer to nothing than this are weighted as if they were this: pixels, centimetres; millimetres
// of height.
constexpr double kNearest = 0.7;
constexpr double kHold = 0.002;  // how much a bearing point resists, in w9 a squared millimetre
constexpr double kFirstDamping = 0.1, kMostDamping = 1e5;
constexpr double kNudge = 1e-6;  // for the derivative of the margin

}  // namespace

SilhouetteFit::SilhouetteFit(const PoseProblem& problem)
    : problem_(problem),
      distance_(signedDistance(problem.target.mask)),
      disc_(std::max(1.0, kDiscRadius / problem.target.pixelsOf256)) {
    std::size_t first = 0;
    for (const Body& body : problem.actors) {
        equations_.emplace_back(body);
        first_.push_back(first);
        first += body.freedoms;
    }
}

double SilhouetteFit::run(SceneEnergy& energy, std::span<double> freedoms, int steps, std::span<const char> moves) {
    energy.pose(freedoms);
    double best = energy.energy();
    ++evaluations_;
    double damping = kFirstDamping;
    bool isLinear = false;
    for (int i = 0; i < steps && damping < kMostDamping; ++i) {
        if (!isLinear) linearise(energy, freedoms), isLinear = true;
        trial_.assign(freedoms.begin(), freedoms.end());
        for (std::size_t a = 0; a < equations_.size(); ++a) {
            const std::size_t first = first_[a], count = problem_.actors[a].freedoms;
            const Eigen::VectorXd& step = equations_[a].step(damping, moves.empty() ? moves : moves.subspan(first, count));
            for (std::size_t k = 0; k < count; ++k) trial_[first + k] += step[static_cast<Eigen::Index>(k)];
            problem_.actors[a].limit(std::span(trial_).subspan(first, count));
        }
        energy.pose(trial_);
        ++evaluations_;
        if (const double now = energy.energy(); now < best) {
            best = now;
            std::copy(trial_.begin(), trial_.end(), freedoms.begin());
            damping = std::max(1e-4, damping / 3);
            isLinear = false;
        } else {
            damping *= 4;
        }
    }
    energy.pose(freedoms);
    energy.terms();
    return best;
}

void SilhouetteFit::linearise(SceneEnergy& energy, std::span<const double> freedoms) {
    energy.pose(freedoms);
    energy.terms();
    for (std::size_t a = 0; a < equations_.size(); ++a)
        equations_[a].begin(energy.posed(a), freedoms.subspan(first_[a], problem_.actors[a].freedoms));
    addContour(energy);
    addHints(energy);
    addPhysics(energy, freedoms);
    for (PoseEquations& equations : equations_) equations.finish();
}

// A point of the shadow's contour belongs to the capsule on whose outline it lies: of those whose shadow is nearest, the first.
void SilhouetteFit::addContour(SceneEnergy& energy) {
    const PoseTarget& target = problem_.target;
    const ScreenFrame& frame = target.frame;
    struct Outline {
        glm::dvec2 from, along;
        double fromRadius, toRadius, square;
    };
    std::vector<std::vector<Outline>> outlines(equations_.size());
    for (std::size_t a = 0; a < outlines.size(); ++a)
        for (const PlacedCapsule& capsule : energy.posed(a).capsules()) {
            const glm::dvec3 d = frame.fromLight(capsule.from), e = frame.fromLight(capsule.to);
            const glm::dvec2 from = frame.shadow(capsule.from), to = frame.shadow(capsule.to);
            outlines[a].push_back({from, to - from, frame.focus() * capsule.fromRadius / d.z,
                                   frame.focus() * capsule.toRadius / e.z, glm::dot(to - from, to - from)});
        }
    const PoseWeights& weights = problem_.weights;
    const double squarePixel = target.pixelsOf256 * target.pixelsOf256 * target.perPoint();
    // `residual`: how far beyond its place the outline is along the outward normal, pixels.
    const auto add = [&](glm::dvec2 pixel, glm::dvec2 normal, double residual, double weight) {
        std::size_t owner = 0, index = 0;
        double least = 3, share = 0;
        bool isFound = false;
        const glm::ivec2 whole(pixel);
        for (std::size_t a = 0; a < outlines.size(); ++a) {
            if (!energy.shadow(a).at(whole.x, whole.y)) continue;
            for (std::size_t c = 0; c < outlines[a].size(); ++c) {
                const Outline& outline = outlines[a][c];
                const glm::dvec2 away = pixel - outline.from;
                const double t = outline.square > 0 ? std::clamp(glm::dot(away, outline.along) / outline.square, 0.0, 1.0) : 0;
                const glm::dvec2 aside = away - t * outline.along;
                const double reach = least + std::lerp(outline.fromRadius, outline.toRadius, t);
                if (reach <= 0 || glm::dot(aside, aside) >= reach * reach) continue;
                least = glm::length(aside) - (reach - least);
                isFound = true, owner = a, index = c, share = t;
            }
        }
        if (!isFound) return;
        const PosedBody& body = energy.posed(owner);
        const PlacedCapsule& capsule = body.capsule(index);
        const double radius = std::lerp(capsule.fromRadius, capsule.toRadius, share);
        const glm::dvec3 point = glm::mix(capsule.from, capsule.to, share) + radius * glm::dvec3(normal.x, -normal.y, 0);
        // The derivative of foot + focus (x, y) / z along the normal, by metres of the stage: x right, y up, z to the light.
        const glm::dvec3 d = frame.fromLight(point);
        const double scale = frame.focus() / d.z, forward = (normal.x * d.x + normal.y * d.y) / d.z;
        equations_[owner].addPoint(problem_.actors[owner].capsules[index].joint, point,
                                   scale * glm::dvec3(normal.x, -normal.y, forward), residual, weight);
    };

    // Equation 2: the contour's points pull the nearest point of the shadow's contour.
    const auto nearest = energy.nearest();
    for (std::size_t i = 0; i < nearest.size(); ++i) {
        const glm::dvec2 away = target.contour[i].pixel - nearest[i].pixel;
        const double along = std::clamp(glm::dot(away, nearest[i].normal), -kFarthest, kFarthest);
        if (nearest[i].normal != glm::dvec2(0)) add(nearest[i].pixel, nearest[i].normal, -along, weights.w1 * squarePixel);
    }
    // Equation 3: so many pixels of the shadow's contour stand for all of them, each for as much area as it is off.
    const BitMask& contour = energy.contour();
    const std::int64_t all = contour.count(), stride = std::max<std::int64_t>(1, all / kShadowPoints);
    const double charge = weights.w4 / target.area * static_cast<double>(stride);
    std::int64_t index = 0;
    for (int y = std::max(0, contour.rowsFrom()); y < contour.rowsTo(); ++y)
        for (std::size_t word = 0; word < static_cast<std::size_t>(contour.stride()); ++word)
            for (std::uint64_t bits = contour.row(y)[word]; bits != 0; bits &= bits - 1) {
                if (index++ % stride != 0) continue;
                const glm::ivec2 pixel(static_cast<int>(word) * BitMask::kBits + std::countr_zero(bits), y);
                const ContourPoint point = disc_.at(energy.shadow(), pixel);
                if (point.normal == glm::dvec2(0)) continue;
                const double inside = std::clamp(double(distance_.at(pixel.x, pixel.y)), -kFarthest, kIntoHole);
                if (std::abs(inside) > 0.5)
                    add(pixel, point.normal, -inside, 0.5 * charge / std::max(kNearest, std::abs(inside)));
            }
}

// Equation 7: the nearest part goes to its hint, to the right and down alike.
void SilhouetteFit::addHints(const SceneEnergy& energy) {
    const ScreenFrame& frame = problem_.target.frame;
    const double weight = problem_.weights.w12 * problem_.target.pixelsOf256 * problem_.target.pixelsOf256;
    for (std::size_t i = 0; i < problem_.hints.size(); ++i) {
        const auto [actor, match] = energy.hintOwner(i);
        const Body::Point& part = problem_.actors[actor].parts[static_cast<std::size_t>(match.part)];
        const glm::dvec3 point = energy.posed(actor).point(part), d = frame.fromLight(point);
        if (d.z <= 0) continue;  // no shadow to move
        // The derivative of foot + focus (x, y) / z.
        const double scale = frame.focus() / d.z;
        equations_[actor].addPoint(part.joint, point, scale * glm::dvec3(1, 0, d.x / d.z), match.away.x, weight);
        equations_[actor].addPoint(part.joint, point, scale * glm::dvec3(0, -1, d.y / d.z), match.away.y, weight);
    }
}

// Equation 6, E_k: an actor, or what he holds, leaves what it is in. What another holds is asked for its half in the other's turn.
void SilhouetteFit::addIntrusions(const SceneEnergy& energy, std::size_t actor, double weight) {
    PoseEquations& equations = equations_[actor];
    for (const Intrusion& intrusion : energy.intrusions(actor)) {
        const glm::dvec3 deeper = -1000.0 * intrusion.outward;
        if (intrusion.otherJoint)
            equations.addPoints(intrusion.joint, intrusion.point, deeper, *intrusion.otherJoint, intrusion.point, -deeper,
                                1000 * intrusion.depth, weight);
        else
            equations.addPoint(intrusion.joint, intrusion.point, deeper, 1000 * intrusion.depth, weight);
    }
    for (std::size_t other = 0; other < equations_.size(); ++other) {
        if (other == actor) continue;
        findIntrusions(problem_.actors[actor], energy.posed(actor), energy.held(other), intrusions_);
        for (const Intrusion& in : intrusions_)
            equations.addPoint(in.joint, in.point, -1000.0 * in.outward, 500 * in.depth, weight);
        findIntrusions(problem_.actors[other], energy.posed(other), energy.held(actor), intrusions_);
        for (const Intrusion& in : intrusions_)
            equations.addPoint(*in.otherJoint, in.point, 1000.0 * in.outward, 500 * in.depth, weight);
    }
}

// Equation 6: what is too deep, too high, or out of balance.
void SilhouetteFit::addPhysics(SceneEnergy& energy, std::span<const double> freedoms) {
    PoseWeights weights = problem_.weights;
    for (double* weight : {&weights.w7, &weights.w9, &weights.w10, &weights.w11}) *weight *= weights.stiffness;
    for (std::size_t a = 0; a < equations_.size(); ++a) {
        PoseEquations& equations = equations_[a];
        const Body& body = problem_.actors[a];
        const PosedBody& posed = energy.posed(a);
        // `own`: whether the other capsule is this body's too, on this joint; another's actor is asked for his half in his turn.
        const auto addPair = [&](const PlacedCapsule& one, const PlacedCapsule& other, std::size_t joint,
                                 std::optional<std::size_t> own) {
            if (!areNear(one, other)) return;
            const CapsuleTouch touch = touching(one, other);
            if (touch.depth <= 0) return;
            const glm::dvec3 apart = -1000.0 * touch.normal;
            if (own)
                equations.addPoints(joint, touch.onFirst, apart, *own, touch.onSecond, -apart, 1000 * touch.depth, weights.w10);
            else
                equations.addPoint(joint, touch.onFirst, apart, 500 * touch.depth, weights.w10);
        };
        for (const auto& [i, j] : body.apart)
            addPair(posed.capsule(i), posed.capsule(j), body.capsules[i].joint, body.capsules[j].joint);
        for (std::size_t b = 0; b < equations_.size(); ++b)
            if (b != a)
                for (std::size_t i = 0; i < posed.capsules().size(); ++i)
                    for (const PlacedCapsule& other : energy.posed(b).capsules())
                        addPair(posed.capsule(i), other, body.capsules[i].joint, std::nullopt);
        for (std::size_t i = 0; i < posed.spheres().size(); ++i) {
            const auto& [centre, radius] = posed.spheres()[i];
            for (const int axis : {1, 2})
                if (const double depth = radius - centre[axis]; depth > 0) {
                    glm::dvec3 direction(0);
                    direction[axis] = -1000;
                    equations.addPoint(body.spheres[i].joint, centre, direction, 1000 * depth, weights.w11);
                }
        }
        addIntrusions(energy, a, weights.w11);
        // What bears is not let go of lightly: the margin would be another one then.
        const auto above = energy.aboveGround(a);
        for (std::size_t i = 0; i < above.size(); ++i) {
            const auto& [centre, radius] = posed.spheres()[i];
            if (above[i].centre.y - radius < energy.lowest(a) + kTouch)
                equations.addPoint(body.spheres[i].joint, centre, {0, 1000, 0}, 0, kHold * weights.w9);
        }
        // The margin, the height above the ground and where he stands, by small nudges.
        const double lacking = 100 * (kAmpleMargin - energy.margin(a)), height = 1000 * energy.lowest(a),
                     outside = 1000 * energy.outside(a);
        if (lacking <= 0 && height <= 0 && outside <= 0) continue;
        std::vector<double> nudged(freedoms.begin() + static_cast<std::ptrdiff_t>(first_[a]),
                                   freedoms.begin() + static_cast<std::ptrdiff_t>(first_[a] + body.freedoms));
        const auto size = static_cast<Eigen::Index>(body.freedoms);
        Eigen::VectorXd margins(size), heights(size), ways(size);
        for (std::size_t k = 0; k < body.freedoms; ++k) {
            nudged[k] += kNudge;
            nudged_.pose(body, nudged);
            nudged[k] -= kNudge;
            const auto spheres = overFloor(problem_.stage, nudged_.spheres(), aboveGround_);
            findBearings(spheres, problem_.weights.bearing, contacts_);
            margins[static_cast<Eigen::Index>(k)] =
                -100 * (supportMargin(contacts_, nudged_.massCentre()) - energy.margin(a)) / kNudge;
            heights[static_cast<Eigen::Index>(k)] = 1000 * (lowestOf(spheres) - energy.lowest(a)) / kNudge;
            ways[static_cast<Eigen::Index>(k)] = (1000 * farthestOutside(problem_.stage, contacts_) - outside) / kNudge;
        }
        if (lacking > 0) equations.addRow(margins, lacking, 0.5 * weights.w9 / std::max(kNearest, lacking));
        if (outside > 0) equations.addRow(ways, outside, weights.w11);
        if (height > 0) equations.addRow(heights, height, 0.5 * weights.w7 / std::max(kNearest, height));
    }
}

}  // namespace fantascope::theatre
