#include "theatre/silhouette_fit.h"

#include "theatre/distance_field.h"
#include "theatre/energy_terms.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
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
// Residuals nearer to nothing than this are weighted as if they were this: pixels, centimetres.
constexpr double kNearest = 0.7;
constexpr double kFirstDamping = 0.1, kMostDamping = 1e5;
constexpr double kNudge = 1e-6;  // for the derivative of the margin

}  // namespace

// The normal equations of one actor: a residual moves with one actor's joints alone, or with two that touch, each of whom is then asked for half.
struct SilhouetteFit::ActorSystem {
    explicit ActorSystem(const Body& body)
        : axes(body.freedoms),
          jointOf(body.freedoms, 0),
          above(body.joints.size(), 0),
          hessian(static_cast<Eigen::Index>(body.freedoms), static_cast<Eigen::Index>(body.freedoms)),
          gradient(static_cast<Eigen::Index>(body.freedoms)),
          row(static_cast<Eigen::Index>(body.freedoms)),
          step(static_cast<Eigen::Index>(body.freedoms)) {
        for (std::size_t i = 1; i < body.joints.size(); ++i) {
            for (std::size_t k = 0; k < body.joints[i].motion.size(); ++k) jointOf[body.joints[i].first + k] = i;
            above[i] = above[body.joints[i].parent] | std::uint64_t{1} << i;
        }
    }
    // Adds weight * residual^2 with the residual's derivative in `row`.
    void add(double residual, double weight) {
        hessian.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
        gradient += weight * residual * row;
    }
    // Adds to `row` how a point that turns with `joint` moves along `direction` with each freedom.
    void addRow(const PosedBody& body, std::size_t joint, const glm::dvec3& point, const glm::dvec3& direction) {
        for (std::size_t k = 0; k < 3; ++k) row[static_cast<Eigen::Index>(k)] += direction[static_cast<int>(k)];
        for (std::size_t k = 3; k < axes.size(); ++k) {
            const std::size_t j = jointOf[k];
            if (j != 0 && (above[joint] >> j & 1) == 0) continue;
            row[static_cast<Eigen::Index>(k)] += glm::dot(direction, glm::cross(axes[k], point - body.place(j)));
        }
    }

    std::vector<glm::dvec3> axes;
    std::vector<std::size_t> jointOf;  // of each freedom
    std::vector<std::uint64_t> above;  // of each joint: itself and those above it, the root excepted, as bits
    Eigen::MatrixXd hessian;
    Eigen::VectorXd gradient, row, step;
};

SilhouetteFit::SilhouetteFit(const PoseProblem& problem)
    : problem_(problem),
      distance_(signedDistance(problem.target.mask)),
      disc_(std::max(1.0, kDiscRadius / problem.target.pixelsOf256)) {
    std::size_t first = 0;
    for (const Body& body : problem.actors) {
        actors_.push_back(std::make_unique<ActorSystem>(body));
        first_.push_back(first);
        first += body.freedoms;
    }
}
SilhouetteFit::~SilhouetteFit() = default;

double SilhouetteFit::run(SceneEnergy& energy, std::span<double> freedoms, int steps, std::span<const char> moves) {
    energy.pose(freedoms);
    double best = energy.energy();
    ++evaluations_;
    double damping = kFirstDamping;
    bool isLinear = false;
    for (int i = 0; i < steps && damping < kMostDamping; ++i) {
        if (!isLinear) linearise(energy, freedoms), isLinear = true;
        trial_.assign(freedoms.begin(), freedoms.end());
        for (std::size_t a = 0; a < actors_.size(); ++a) {
            ActorSystem& actor = *actors_[a];
            Eigen::MatrixXd damped = actor.hessian;
            damped.diagonal() = damped.diagonal() * (1 + damping);
            damped.diagonal().array() += 1e-2 * damping + 1e-9;
            actor.step = damped.selfadjointView<Eigen::Lower>().ldlt().solve(-actor.gradient);
            const std::size_t first = first_[a], count = problem_.actors[a].freedoms;
            for (std::size_t k = 0; k < count; ++k)
                if (moves.empty() || moves[first + k] != 0) trial_[first + k] += actor.step[static_cast<Eigen::Index>(k)];
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
    for (std::size_t a = 0; a < actors_.size(); ++a) {
        ActorSystem& actor = *actors_[a];
        actor.hessian.setZero();
        actor.gradient.setZero();
        const Body& body = problem_.actors[a];
        energy.posed(a).axes(body, freedoms.subspan(first_[a], body.freedoms), actor.axes);
    }
    addContour(energy);
    addPhysics(energy, freedoms);
}

// A point of the shadow's contour belongs to the capsule on whose outline it lies: of those whose shadow is nearest, the first.
void SilhouetteFit::addContour(SceneEnergy& energy) {
    const PoseTarget& target = problem_.target;
    const ScreenFrame& frame = target.frame;
    struct Outline {
        std::size_t actor, capsule;
        glm::dvec2 from, along;
        double fromRadius, toRadius, square;
    };
    std::vector<Outline> outlines;
    for (std::size_t a = 0; a < actors_.size(); ++a)
        for (std::size_t c = 0; c < energy.posed(a).capsules().size(); ++c) {
            const PlacedCapsule& capsule = energy.posed(a).capsule(c);
            const glm::dvec3 d = frame.fromLight(capsule.from), e = frame.fromLight(capsule.to);
            const glm::dvec2 from = frame.shadow(capsule.from), to = frame.shadow(capsule.to);
            outlines.push_back({a, c, from, to - from, frame.focus() * capsule.fromRadius / d.z,
                                frame.focus() * capsule.toRadius / e.z, glm::dot(to - from, to - from)});
        }
    const PoseWeights& weights = problem_.weights;
    const double squarePixel = target.pixelsOf256 * target.pixelsOf256 * target.perPoint();
    // `residual`: how far beyond its place the outline is along the outward normal, pixels.
    const auto add = [&](glm::dvec2 pixel, glm::dvec2 normal, double residual, double weight) {
        const Outline* nearest = nullptr;
        double least = 1e30, share = 0;
        const glm::ivec2 whole(pixel);
        for (const Outline& outline : outlines) {
            if (!energy.shadow(outline.actor).at(whole.x, whole.y)) continue;
            const glm::dvec2 away = pixel - outline.from;
            const double t = outline.square > 0 ? std::clamp(glm::dot(away, outline.along) / outline.square, 0.0, 1.0) : 0;
            const double distance = glm::length(away - t * outline.along) - std::lerp(outline.fromRadius, outline.toRadius, t);
            if (distance < least) least = distance, nearest = &outline, share = t;
        }
        if (nearest == nullptr || least > 3) return;
        const PosedBody& body = energy.posed(nearest->actor);
        const PlacedCapsule& capsule = body.capsule(nearest->capsule);
        const double radius = std::lerp(capsule.fromRadius, capsule.toRadius, share);
        const glm::dvec3 point = glm::mix(capsule.from, capsule.to, share) + radius * glm::dvec3(normal.x, -normal.y, 0);
        // The derivative of foot + focus (x, y) / z along the normal, by metres of the stage: x right, y up, z to the light.
        const glm::dvec3 d = frame.fromLight(point);
        const double scale = frame.focus() / d.z, forward = (normal.x * d.x + normal.y * d.y) / d.z;
        ActorSystem& actor = *actors_[nearest->actor];
        actor.row.setZero();
        actor.addRow(body, problem_.actors[nearest->actor].capsules[nearest->capsule].joint, point,
                     scale * glm::dvec3(normal.x, -normal.y, forward));
        actor.add(residual, weight);
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

// Equation 6: what is too deep, too high, or out of balance.
void SilhouetteFit::addPhysics(SceneEnergy& energy, std::span<const double> freedoms) {
    PoseWeights weights = problem_.weights;
    for (double* weight : {&weights.w7, &weights.w9, &weights.w10, &weights.w11}) *weight *= weights.stiffness;
    for (std::size_t a = 0; a < actors_.size(); ++a) {
        ActorSystem& actor = *actors_[a];
        const Body& body = problem_.actors[a];
        const PosedBody& posed = energy.posed(a);
        const auto addPair = [&](const PlacedCapsule& one, const PlacedCapsule& other, std::size_t joint,
                                 std::optional<std::size_t> ownOther) {
            if (!areNear(one, other)) return;
            const CapsuleTouch touch = touching(one, other);
            if (touch.depth <= 0) return;
            actor.row.setZero();
            actor.addRow(posed, joint, touch.onFirst, -1000.0 * touch.normal);
            if (ownOther) actor.addRow(posed, *ownOther, touch.onSecond, 1000.0 * touch.normal);
            actor.add(ownOther ? 1000 * touch.depth : 500 * touch.depth, weights.w10);
        };
        for (const auto& [i, j] : body.apart)
            addPair(posed.capsule(i), posed.capsule(j), body.capsules[i].joint, body.capsules[j].joint);
        for (std::size_t b = 0; b < actors_.size(); ++b)
            if (b != a)
                for (std::size_t i = 0; i < posed.capsules().size(); ++i)
                    for (const PlacedCapsule& other : energy.posed(b).capsules())
                        addPair(posed.capsule(i), other, body.capsules[i].joint, std::nullopt);
        for (std::size_t i = 0; i < posed.capsules().size(); ++i) {
            const PlacedCapsule& capsule = posed.capsule(i);
            for (const auto& [centre, radius] :
                 {std::pair(capsule.from, capsule.fromRadius), std::pair(capsule.to, capsule.toRadius)})
                for (const int axis : {1, 2})
                    if (const double depth = radius - centre[axis]; depth > 0) {
                        glm::dvec3 direction(0);
                        direction[axis] = -1000;
                        actor.row.setZero();
                        actor.addRow(posed, body.capsules[i].joint, centre, direction);
                        actor.add(1000 * depth, weights.w11);
                    }
        }
        // The margin and the height above the floor, by small nudges.
        const double lacking = 100 * (kAmpleMargin - energy.margin(a)), height = 100 * posed.lowest();
        if (lacking <= 0 && height <= 0) continue;
        std::vector<double> nudged(freedoms.begin() + static_cast<std::ptrdiff_t>(first_[a]),
                                   freedoms.begin() + static_cast<std::ptrdiff_t>(first_[a] + body.freedoms));
        Eigen::VectorXd heights(actor.row.size());
        for (std::size_t k = 0; k < body.freedoms; ++k) {
            nudged[k] += kNudge;
            nudged_.pose(body, nudged);
            nudged[k] -= kNudge;
            findContacts(nudged_.capsules(), contacts_);
            actor.row[static_cast<Eigen::Index>(k)] =
                -100 * (supportMargin(contacts_, nudged_.massCentre()) - energy.margin(a)) / kNudge;
            heights[static_cast<Eigen::Index>(k)] = 100 * (nudged_.lowest() - posed.lowest()) / kNudge;
        }
        if (lacking > 0) actor.add(lacking, 0.5 * weights.w9 / std::max(kNearest, lacking));
        actor.row = heights;
        if (height > 0) actor.add(height, 0.5 * weights.w7 / std::max(kNearest, height));
    }
}

}  // namespace fantascope::theatre
