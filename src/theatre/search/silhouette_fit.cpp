#include "theatre/search/silhouette_fit.h"

#include "theatre/energy/energy_terms.h"
#include "theatre/mask/distance_field.h"

#include "core/check.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace fantascope::theatre {
namespace {

// The approximate number of the shadow's contour points that have a residual.
constexpr int kShadowPoints = 500;
// The greatest residual of a point, pixels. Beyond it the derivative is meaningless.
constexpr double kFarthest = 12;
// A hole's edge lies deep in the target. Its residual is at most this, pixels.
constexpr double kIntoHole = 6;
// Smaller residuals are weighted as if they were this: pixels, centimetres of margin, millimetres
// of height.
constexpr double kNearest = 0.7;
constexpr double kNarrow = 0.01;  // metres; tangents this near to the least margin have residuals: both sides of a narrow support
constexpr double kHold = 0.002;   // resistance of a bearing point to vertical movement, in w9 a squared millimetre
constexpr double kFirstDamping = 0.1, kMostDamping = 1e5;

// The outlines of the shadows of a body's capsules, approximated by two circles and straight lines
// between.
class Outlines {
public:
    static constexpr double kNear = 3;  // pixels

    Outlines(const ScreenFrame& frame, const PosedBody& posed)
        : rows_(bands(frame.height()), 0), columns_(bands(frame.width()), 0) {
        FANTASCOPE_CHECK(posed.capsules().size() <= 64, "a set of capsules is a word");
        for (const PlacedCapsule& capsule : posed.capsules()) {
            const double fromDepth = frame.fromLight(capsule.from).z, toDepth = frame.fromLight(capsule.to).z;
            if (fromDepth <= capsule.fromRadius || toDepth <= capsule.toRadius) {  // reaches the light: no bounded shadow
                outlines_.push_back({});
                continue;
            }
            const glm::dvec2 from = frame.shadow(capsule.from), to = frame.shadow(capsule.to), along = to - from;
            const double fromRadius = frame.focus() * capsule.fromRadius / fromDepth;
            const double toRadius = frame.focus() * capsule.toRadius / toDepth;
            const std::uint64_t bit = std::uint64_t{1} << outlines_.size();
            const glm::dvec2 reach(std::max(fromRadius, toRadius) + kNear);
            note(columns_, glm::min(from, to).x - reach.x, glm::max(from, to).x + reach.x, bit);
            note(rows_, glm::min(from, to).y - reach.y, glm::max(from, to).y + reach.y, bit);
            outlines_.push_back({from, along, fromRadius, toRadius - fromRadius, 1 / std::max(1e-9, glm::dot(along, along))});
        }
    }

    struct Nearest {
        bool isFound = false;
        std::size_t capsule = 0;
        double share = 0;         // position along its axis, 0 .. 1
        double distance = kNear;  // from its outline, pixels; negative inside
    };
    // Whether one of the outlines is nearer to a pixel than `nearest`, which is then updated.
    bool findNearer(glm::dvec2 pixel, Nearest& nearest) const {
        bool isNearer = false;
        for (std::uint64_t near = rows_[band(pixel.y)] & columns_[band(pixel.x)]; near != 0; near &= near - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(near));
            const Outline& outline = outlines_[i];
            const glm::dvec2 away = pixel - outline.from;
            const double t = std::clamp(glm::dot(away, outline.along) * outline.perSquare, 0.0, 1.0);
            const glm::dvec2 aside = away - t * outline.along;
            const double radius = outline.radius + t * outline.growth, reach = nearest.distance + radius;
            if (reach <= 0 || glm::dot(aside, aside) >= reach * reach) continue;
            nearest = {true, i, t, glm::length(aside) - radius};
            isNearer = true;
        }
        return isNearer;
    }

private:
    struct Outline {
        glm::dvec2 from{0}, along{0};
        double radius = 0, growth = 0, perSquare = 0;
    };
    // The capsules that come near to each band of rows, and of columns, as bits.
    static constexpr int kBand = 8;  // pixels
    static std::size_t bands(int pixels) { return static_cast<std::size_t>(pixels / kBand + 1); }
    static std::size_t band(double at) { return static_cast<std::size_t>(at / kBand); }
    static void note(std::vector<std::uint64_t>& bands, double from, double to, std::uint64_t bit) {
        const double last = double(bands.size()) - 1;
        if (to < 0 || from / kBand > last + 1) return;
        const auto end = static_cast<std::size_t>(std::clamp(to / kBand, 0.0, last));
        for (auto i = static_cast<std::size_t>(std::clamp(from / kBand, 0.0, last)); i <= end; ++i) bands[i] |= bit;
    }

    std::vector<Outline> outlines_;
    std::vector<std::uint64_t> rows_, columns_;
};

}  // namespace

SilhouetteFit::SilhouetteFit(const PoseProblem& problem) : problem_(problem) {
    for (std::size_t i = 0; i < problem.targets.size(); ++i) distances_.push_back(signedDistance(problem.targets[i].mask));
    std::size_t first = 0;
    for (const Body& body : problem.actors) {
        equations_.emplace_back(body);
        kinematics_.emplace_back(body);
        first_.push_back(first);
        first += body.dofs;
    }
}

double SilhouetteFit::run(SceneEnergy& energy, std::span<double> dofs, int steps, double stiffness, std::span<const char> moves) {
    energy.pose(dofs, stiffness);
    double best = energy.energy();
    ++evaluations_;
    double damping = kFirstDamping;
    bool isLinear = false, isPosed = true;  // `energy` is posed by `dofs`
    for (int i = 0; i < steps && damping < kMostDamping; ++i) {
        if (!isLinear) linearise(energy, dofs), isLinear = true;
        trial_.assign(dofs.begin(), dofs.end());
        for (std::size_t a = 0; a < equations_.size(); ++a) {
            const std::size_t first = first_[a], count = problem_.actors[a].dofs;
            const Eigen::VectorXd& step = equations_[a].step(damping, moves.empty() ? moves : moves.subspan(first, count));
            for (std::size_t k = 0; k < count; ++k) trial_[first + k] += step[static_cast<Eigen::Index>(k)];
            const auto pose = std::span(trial_).subspan(first, count);
            problem_.actors[a].limit(pose);
            if (!problem_.continuity.empty()) kinematics_[a].hold(pose, problem_.continuity[a].contacts);
        }
        energy.pose(trial_, stiffness);
        ++evaluations_;
        if (const double now = energy.energy(); now < best) {
            best = now;
            std::copy(trial_.begin(), trial_.end(), dofs.begin());
            damping = std::max(1e-4, damping / 3);
            isLinear = false;
            isPosed = true;
        } else {
            damping *= 4;
            isPosed = false;
        }
    }
    if (!isPosed) {
        energy.pose(dofs, stiffness);
        energy.terms();
    }
    return best;
}

void SilhouetteFit::linearise(SceneEnergy& energy, std::span<const double> dofs) {
    for (std::size_t a = 0; a < equations_.size(); ++a)
        equations_[a].begin(energy.posed(a), dofs.subspan(first_[a], problem_.actors[a].dofs));
    for (std::size_t i = 0; i < distances_.size(); ++i) addContour(energy.beam(i), energy, distances_[i]);
    addHints(energy);
    addPhysics(energy);
    if (!problem_.continuity.empty()) addContinuity(energy, dofs);
    for (PoseEquations& equations : equations_) equations.finish();
}

// A point of the shadow's contour belongs to the capsule whose outline is nearest; ties go to the
// first.
void SilhouetteFit::addContour(const BeamEnergy& beam, const SceneEnergy& energy, const GreyImage& distance) {
    const PoseTarget& target = beam.target();
    const ScreenFrame& frame = target.frame;
    const ContourDisc disc(std::max(1.0, kDiscRadius / target.refPixelsPerPixel));
    std::vector<Outlines> outlines;
    for (std::size_t a = 0; a < equations_.size(); ++a) outlines.emplace_back(frame, energy.posed(a));
    const PoseWeights& weights = problem_.weights;
    const double squarePixel = target.refPixelsPerPixel * target.refPixelsPerPixel * target.perPoint();
    // `residual`: the distance of the outline beyond its wanted place, along the outward normal,
    // pixels.
    const auto add = [&](glm::dvec2 pixel, glm::dvec2 normal, double residual, double weight) {
        std::size_t owner = 0;
        Outlines::Nearest nearest;
        const glm::ivec2 whole(pixel);
        for (std::size_t a = 0; a < outlines.size(); ++a)
            if (beam.shadow(a).at(whole.x, whole.y) && outlines[a].findNearer(pixel, nearest)) owner = a;
        if (!nearest.isFound) return;
        const PosedBody& body = energy.posed(owner);
        const PlacedCapsule& capsule = body.capsule(nearest.capsule);
        const double radius = std::lerp(capsule.fromRadius, capsule.toRadius, nearest.share);
        const glm::dvec3 point = glm::mix(capsule.from, capsule.to, nearest.share) + radius * glm::dvec3(normal.x, -normal.y, 0);
        // The derivative of foot + focus (x, y) / z along the normal, by metres in the stage's
        // frame.
        const glm::dvec3 d = frame.fromLight(point);
        const double scale = frame.focus() / d.z, forward = (normal.x * d.x + normal.y * d.y) / d.z;
        equations_[owner].addPoint(problem_.actors[owner].capsules[nearest.capsule].joint, point,
                                   frame.onStage(scale * glm::dvec3(normal, -forward)), residual, weight);
    };

    // Equation 2: each point of the target's contour pulls the nearest point of the shadow's
    // contour.
    const auto pulled = beam.nearest();
    for (std::size_t i = 0; i < pulled.size(); ++i) {
        const glm::dvec2 away = target.contour[i].pixel - pulled[i].pixel;
        const double along = std::clamp(glm::dot(away, pulled[i].normal), -kFarthest, kFarthest);
        if (pulled[i].normal != glm::dvec2(0)) add(pulled[i].pixel, pulled[i].normal, -along, weights.w1 * squarePixel);
    }
    // Equation 3: a sample of the shadow's contour pixels stands for all of them. Each accounts for
    // an area proportional to its distance from the target's contour.
    const BitMask& contour = beam.contour();
    const std::int64_t all = contour.count(), stride = std::max<std::int64_t>(1, all / kShadowPoints);
    const double charge = weights.w4 / target.area * static_cast<double>(stride);
    std::int64_t index = 0;
    for (int y = std::max(0, contour.rowsFrom()); y < contour.rowsTo(); ++y)
        for (std::size_t word = 0; word < static_cast<std::size_t>(contour.stride()); ++word)
            for (std::uint64_t bits = contour.row(y)[word]; bits != 0; bits &= bits - 1) {
                if (index++ % stride != 0) continue;
                const glm::ivec2 pixel(static_cast<int>(word) * BitMask::kBits + std::countr_zero(bits), y);
                const double inside = std::clamp(double(distance.at(pixel.x, pixel.y)), -kFarthest, kIntoHole);
                if (std::abs(inside) <= 0.5) continue;
                const ContourPoint point = disc.at(beam.shadow(), pixel);
                if (point.normal != glm::dvec2(0))
                    add(pixel, point.normal, -inside, 0.5 * charge / std::max(kNearest, std::abs(inside)));
            }
}

// Equation 7: the nearest part goes to its hint, with a residual along each axis of the picture.
void SilhouetteFit::addHints(const SceneEnergy& energy) {
    const ScreenFrame& frame = problem_.targets[0].frame;
    const double weight = problem_.weights.w12 * problem_.targets[0].refPixelsPerPixel * problem_.targets[0].refPixelsPerPixel;
    for (std::size_t i = 0; i < problem_.hints.size(); ++i) {
        const auto [actor, match] = energy.hintOwner(i);
        if (!match.point) continue;
        const glm::dvec3 point = energy.posed(actor).point(*match.point), d = frame.fromLight(point);
        // The derivative of foot + focus (x, y) / z.
        const double scale = frame.focus() / d.z;
        equations_[actor].addPoint(match.point->joint, point, frame.onStage(scale * glm::dvec3(1, 0, -d.x / d.z)), match.away.x,
                                   weight);
        equations_[actor].addPoint(match.point->joint, point, frame.onStage(scale * glm::dvec3(0, 1, -d.y / d.z)), match.away.y,
                                   weight);
    }
}

// Equation 6, E_k: an actor and the props that he holds leave obstacles. If the obstacle is another
// actor's prop, each of the two takes half of the way.
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

// Equations 8 and 10, by equation 9, and equation 11.
void SilhouetteFit::addContinuity(const SceneEnergy& energy, std::span<const double> dofs) {
    const PoseWeights& weights = problem_.weights;
    for (std::size_t a = 0; a < equations_.size(); ++a) {
        const Body& body = problem_.actors[a];
        const PosedBody& posed = energy.posed(a);
        const auto own = dofs.subspan(first_[a], body.dofs);
        const Continuity& others = problem_.continuity[a];
        const auto pull = [&](const ActorPose& to, double weight) {
            equations_[a].addPlace(0, posed.place(0), posed.place(0) - to.root, weight * kRootWeight);
            equations_[a].addBend(0, turnBetween(to.turns[0], posed.turn(0)), weight * kTurnWeight);
            for (std::size_t i = 1; i < body.joints.size(); ++i) {
                const Body::Joint& joint = body.joints[i];
                const glm::dquat turn = joint.motion.orientation(own.subspan(joint.first, joint.motion.size()));
                equations_[a].addBend(i, posed.turn(joint.parent) * turnBetween(to.turns[i], turn), weight * kTurnWeight);
            }
        };
        for (const ActorPose& beside : others.neighbours) pull(beside, weights.w13);
        if (others.principal) pull(*others.principal, weights.w14);
        for (const HeldContact& contact : others.contacts) {
            const glm::dvec3& place = posed.place(contact.joint);
            equations_[a].addPlace(contact.joint, place, place - contact.place, 1e6 * weights.w15);
            equations_[a].addTurn(contact.joint, turnBetween(contact.turn, posed.turn(contact.joint)), weights.w16);
        }
    }
}

// Equation 6: penetrations, and the resistance of bearing points.
void SilhouetteFit::addPhysics(SceneEnergy& energy) {
    PoseWeights weights = problem_.weights;
    for (double* weight : {&weights.w7, &weights.w9, &weights.w10, &weights.w11}) *weight *= energy.stiffness();
    for (std::size_t a = 0; a < equations_.size(); ++a) {
        PoseEquations& equations = equations_[a];
        const Body& body = problem_.actors[a];
        const PosedBody& posed = energy.posed(a);
        // `own`: the other capsule's joint if it belongs to the same body. If not, each of the two
        // actors takes half of the way.
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
                for (std::size_t i = 0; i < posed.capsules().size(); ++i) {
                    if (!energy.posed(b).isNear(posed.capsule(i))) continue;
                    for (const PlacedCapsule& other : energy.posed(b).capsules())
                        addPair(posed.capsule(i), other, body.capsules[i].joint, std::nullopt);
                }
        for (std::size_t i = 0; i < posed.spheres().size(); ++i) {
            const auto& [centre, radius] = posed.spheres()[i];
            glm::dvec3 outward(0, 1, 0);
            const auto push = [&](double depth) {
                if (depth > 0) equations.addPoint(body.spheres[i].joint, centre, -1000.0 * outward, 1000 * depth, weights.w11);
            };
            push(radius - centre.y);
            for (const Screen& screen : problem_.stage.screens) push(radius - screen.distance(centre, outward));
        }
        addIntrusions(energy, a, weights.w11);
        // Bearing points resist a change of height, since losing one would change the margin
        // abruptly.
        const auto above = energy.aboveGround(a);
        const double lowest = energy.bearings(a).lowest;
        for (std::size_t i = 0; i < above.size(); ++i) {
            const auto& [centre, radius] = posed.spheres()[i];
            if (above[i].centre.y - radius < lowest + kTouch)
                equations.addPoint(body.spheres[i].joint, centre, {0, 1000, 0}, 0, kHold * weights.w9);
        }
        addBalance(energy, a, weights);
    }
}

// Residuals for the standing area, the height above the floor and the margin. The margin depends on
// the movement of the contacts on the nearest tangents relative to the mass centre.
void SilhouetteFit::addBalance(const SceneEnergy& energy, std::size_t index, const PoseWeights& weights) {
    PoseEquations& equations = equations_[index];
    const Body& body = problem_.actors[index];
    const PosedBody& posed = energy.posed(index);
    const Contacts& contacts = energy.bearings(index);
    // A vertex of the skin moves with the joint that has the largest share of it.
    const auto jointOf = [&](std::uint32_t source) {
        return problem_.skins.empty() ? body.spheres[source].joint : problem_.skins[index]->joints[source][0];
    };
    // Heights of contacts are measured from the ground; on a platform the ground is higher than the
    // floor.
    const auto groundUnder = [&](std::uint32_t source) {
        return problem_.skins.empty() ? posed.spheres()[source].centre.y - energy.aboveGround(index)[source].centre.y
                                      : double(energy.skin(index)[source].y - energy.skinAboveGround(index)[source].y);
    };
    const std::size_t lowestJoint = jointOf(contacts.lowestSource);
    const glm::dvec3 lowest = problem_.skins.empty() ? posed.spheres()[contacts.lowestSource].centre
                                                     : glm::dvec3(energy.skin(index)[contacts.lowestSource]);
    for (const Contact& contact : contacts.discs) {
        if (!problem_.stage.standing) break;
        const double outside = problem_.stage.standing->outside(contact.place);
        if (outside <= 0 || outside < energy.outside(index)) continue;
        const glm::dvec2 away =
            (contact.place - glm::clamp(contact.place, problem_.stage.standing->from, problem_.stage.standing->to)) / outside;
        equations.addPoint(jointOf(contact.source), contact.point, 1000.0 * glm::dvec3(away.x, 0, away.y), 1000 * outside,
                           weights.w11);
    }
    if (const double height = 1000 * contacts.lowest; height > 0)
        equations.addPoint(lowestJoint, lowest, {0, 1000, 0}, height, 0.5 * weights.w7 / std::max(kNearest, height));

    contacts.support.findTangents(posed.massCentre(), kNarrow, tangents_);
    for (const SupportTangent& tangent : tangents_) {
        const double lacking = lackOfMargin(tangent.margin);
        if (lacking <= 0) continue;
        const double centimetre = tangent.margin < kSureMargin ? 100 * kUnsure : 100;  // centimetres that a metre counts for
        const glm::dvec3 outward(tangent.outward.x, 0, tangent.outward.y), up(0, 1, 0);
        Eigen::VectorXd row = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(body.dofs));
        for (const SupportTangent::Touch& touch : tangent.touches) {
            const Contact& contact = contacts.discs[touch.contact];
            // A contact that rises relative to the lowest point moves inwards: a partly bearing one
            // towards the lowest point, the cut of an edge along the edge.
            double inwards = 0;
            if (contact.share < 1)
                inwards = (glm::dot(outward, contact.point - lowest) + contact.radius / contact.share) / energy.bearingDepth();
            else if (contact.along.y != 0)
                inwards = glm::dot(outward, contact.along) / contact.along.y;
            const double metre = touch.share * centimetre;
            equations.addMotion(row, jointOf(contact.source), contact.point + groundUnder(contact.source) * up,
                                -metre * (contact.share * outward - inwards * up));
            equations.addMotion(row, lowestJoint, lowest, -metre * ((1 - contact.share) * outward + inwards * up));
        }
        const double mass = body.mass();
        for (std::size_t i = 0; i < body.joints.size(); ++i)
            equations.addMotion(row, i, posed.point(i, body.joints[i].massCentre),
                                centimetre * body.joints[i].mass / mass * outward);
        equations.addRow(row, lacking, 0.5 * weights.w9 / std::max(kNearest, lacking));
    }
}

}  // namespace fantascope::theatre
