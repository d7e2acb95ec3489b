#include "theatre/motion/motion_adaptation.h"

#include "theatre/motion/generalised_cone.h"
#include "theatre/search/inverse_kinematics.h"
#include "theatre/search/streams.h"
#include "theatre/search/workshop.h"

#include "core/check.h"
#include "core/parallel.h"
#include "core/random.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <numeric>

namespace fantascope::theatre {
namespace {

constexpr int kReachSteps = 20, kWalkSteps = 8, kFitSteps = 30, kRefitSteps = 12, kLastFitSteps = 15, kPassSteps = 12;
// Steps from a frame to the next: how far the fastest corner moves in a step that a fit can follow,
// as a share of the silhouette's height; and the maximum number of steps.
constexpr double kStride = 0.02;
constexpr int kMostStrides = 20;
constexpr double kClearlyLess = 0.02;  // of intersection over union
// The stiffness of physics on the way back from kMending; and the search for a single actor whom
// mending does not help.
constexpr std::array kRelaxing = {8.0, 4.0, 2.0, 1.0};
constexpr DofSearch::Settings kAlone{.sigma = 0.05, .population = 16, .generations = 15, .stiffness = kMending.back()};

class Adaptation {
public:
    Adaptation(const MotionProblem& motion, std::span<const double> dofs, std::uint64_t seed,
               const MotionAdaptation::Options& options, const AdaptationWatch& watch, MotionAdaptation::Frames known)
        : motion_(motion), seed_(seed), options_(options), watch_(watch), frames_(std::move(known)) {
        frames_.resize(motion.targets.size());
        const PoseProblem& principal = motion.principal;
        const GeneralisedCone cone(principal.stage.beams[0].light, motion.triangles, motion.corners[motion.representative]);
        PosedBody posed;
        for (std::size_t a = 0; a < principal.actors.size(); ++a) {
            const Body& body = principal.actors[a];
            const auto own = dofs.subspan(principal.firstDof(a), body.dofs);
            posed.pose(body, own);
            std::vector<GeneralisedCone::Coordinates>& coordinates = coordinates_.emplace_back();
            for (std::size_t i = 0; i < body.joints.size(); ++i) coordinates.push_back(cone.coordinates(posed.place(i)));
            continuity_.push_back({{}, poseOf(body, own), bearingParts(body, principal.stage, posed)});
        }
        auto& representative = frames_[motion.representative];
        if (!representative) {
            representative.emplace().dofs.assign(dofs.begin(), dofs.end());
            representative->poses = posesOf(dofs);
        }
        for (std::size_t i = 0; i < frames_.size(); ++i)
            if (frames_[i]) {
                if (i != motion.representative) frames_[i]->dofs = dofsOf(frames_[i]->poses);
                frames_[i]->quality = PoseSearch::measure(problemAt(i), frames_[i]->dofs);
            }
    }

    MotionAdaptation::Frames run() {
        // The forward and the backward pass are independent. In a loop they go on until they meet.
        const std::size_t count = frames_.size(), before = motion_.loops ? (count - 1) / 2 : motion_.representative;
        parallelFor(2, options_.threads, [&](int way) {
            const std::size_t steps = way == 0 ? count - 1 - before : before;
            std::size_t from = motion_.representative;
            for (std::size_t step = 0; step < steps; ++step) {
                const std::size_t i = (from + (way == 0 ? 1 : count - 1)) % count;
                if (!frames_[i]) {
                    auto frame = adapted(i, from);
                    if (!frame) break;
                    keep(i, std::move(*frame));
                }
                from = i;
            }
        });
        for (int pass = 0; pass < options_.passes && !mustStop(); ++pass) settle();
        return std::move(frames_);
    }

private:
    PoseProblem problemAt(std::size_t frame) const {
        PoseProblem problem = motion_.principal;
        problem.targets[0] = motion_.targets[frame];
        problem.continuity = continuity_;
        return problem;
    }
    std::vector<ActorPose> posesOf(std::span<const double> dofs) const {
        std::vector<ActorPose> poses;
        const PoseProblem& principal = motion_.principal;
        for (std::size_t a = 0; a < principal.actors.size(); ++a)
            poses.push_back(poseOf(principal.actors[a], dofs.subspan(principal.firstDof(a), principal.actors[a].dofs)));
        return poses;
    }
    std::vector<double> dofsOf(const std::vector<ActorPose>& poses) const {
        std::vector<double> dofs;
        for (std::size_t a = 0; a < poses.size(); ++a) {
            const std::vector<double> own = theatre::dofsOf(motion_.principal.actors[a], poses[a]);
            dofs.insert(dofs.end(), own.begin(), own.end());
        }
        return dofs;
    }
    void addNeighbour(PoseProblem& problem, const AdaptedFrame& frame) const {
        for (std::size_t a = 0; a < problem.actors.size(); ++a) problem.continuity[a].neighbours.push_back(frame.poses[a]);
    }

    // Algorithm 1, lines 7 and 8: the guess through the generalised cone.
    std::vector<double> throughCone(std::size_t frame, std::vector<double> dofs) const {
        const PoseProblem& principal = motion_.principal;
        const GeneralisedCone cone(principal.stage.beams[0].light, motion_.triangles, motion_.corners[frame]);
        std::vector<glm::dvec3> places;
        for (std::size_t a = 0; a < principal.actors.size(); ++a) {
            const Body& body = principal.actors[a];
            places.clear();
            for (const GeneralisedCone::Coordinates& joint : coordinates_[a]) places.push_back(cone.point(joint));
            const auto own = std::span(dofs).subspan(principal.firstDof(a), body.dofs);
            InverseKinematics(body).reach(own, places, continuity_[a].contacts, kReachSteps);
        }
        return dofs;
    }

    bool mustStop() {
        const std::lock_guard lock(mutex_);
        isStopped_ = isStopped_ || (watch_.askStop && watch_.askStop());
        return isStopped_;
    }
    void keep(std::size_t i, AdaptedFrame frame) {
        const std::lock_guard lock(mutex_);
        // The frame is converted to the precision of the file. So a run that continues from a file
        // gives the same result.
        frame.poses = posesOf(frame.dofs);
        frame.dofs = dofsOf(frame.poses);
        frames_[i] = std::move(frame);
        if (watch_.tell) watch_.tell(i, *frames_[i]);
    }

    // The silhouette between two frames, with its triangles' corners interpolated.
    PoseTarget between(std::size_t from, std::size_t to, double share) const {
        const PoseTarget& target = motion_.targets[to];
        std::vector<glm::dvec2> corners;
        for (std::size_t i = 0; i < motion_.corners[to].size(); ++i) {
            const glm::dvec2 corner = glm::mix(motion_.corners[from][i], motion_.corners[to][i], share);
            corners.push_back(target.frame.pixelAt(corner.x, corner.y));
        }
        return target.reshaped(filled(target.mask.width(), target.mask.height(), motion_.triangles, corners));
    }

    // Moves poses from one frame towards another, in steps that a fit can follow. A fit fails if
    // the silhouette moves by more than the thickness of a limb.
    void walk(std::size_t from, std::size_t to, AdaptedFrame& frame) const {
        double farthest = 0;
        for (std::size_t i = 0; i < motion_.corners[to].size(); ++i)
            farthest = std::max(farthest, glm::distance(motion_.corners[from][i], motion_.corners[to][i]));
        const PoseTarget& target = motion_.targets[to];
        const double height = 256 / target.refPixelsPerPixel * target.frame.pixel();
        const int steps = static_cast<int>(std::min(double{kMostStrides}, std::ceil(farthest / (kStride * height))));
        for (int step = 1; step < steps; ++step) {
            PoseProblem problem = problemAt(to);
            problem.targets[0] = between(from, to, double(step) / steps);
            Workshop shop(simpler(in256Rows(std::move(problem))));
            shop.fit.run(shop.energy, frame.dofs, kWalkSteps);
            frame.evaluations += shop.evaluations();
        }
    }

    // Algorithm 1, line 10, from the poses of an adjacent frame. None if the run is stopped before
    // it is done.
    std::optional<AdaptedFrame> adapted(std::size_t frame, std::size_t beside) {
        PoseProblem problem = problemAt(frame);
        addNeighbour(problem, *frames_[beside]);
        Workshop shop(simpler(in256Rows(problem)));
        AdaptedFrame found{{}, frames_[beside]->dofs, {}, 0};
        walk(beside, frame, found);
        double energy = shop.fit.run(shop.energy, found.dofs, kFitSteps), iou = shop.iou();
        const auto offer = [&](std::vector<double> other) {
            const double now = shop.fit.run(shop.energy, other, kFitSteps);
            if (now < energy) found.dofs = std::move(other), energy = now, iou = shop.iou();
        };
        offer(throughCone(frame, frames_[beside]->dofs));
        if (iou < options_.wanted) {
            Workshop coarse(forFirstLook(shop.problem));
            offer(searched(coarse, frame, found.dofs));
            found.evaluations += coarse.evaluations();
        }
        if (mustStop()) return std::nullopt;
        found.evaluations += shop.evaluations();
        finish(frame, problem, found, kLastFitSteps);
        return found;
    }

    // A local search that accepts only lower energies, so that the poses stay near to where they
    // were.
    std::vector<double> searched(Workshop& shop, std::size_t frame, std::vector<double> dofs) {
        Rng rng(streamSeed(seed_, {Stream::Moves, frame}));
        shop.energy.pose(dofs);
        double energy = shop.energy.energy();
        for (int i = 0; i < options_.searches && !mustStop(); ++i) {
            std::vector<double> other = dofs;
            shop.search.disturb(shop.energy, other, rng);
            const double now = shop.fit.run(shop.energy, other, kRefitSteps);
            if (now < energy) dofs = std::move(other), energy = now;
        }
        return dofs;
    }

    // The last fits, on the full skins, until everyone stands.
    void finish(std::size_t i, const PoseProblem& problem, AdaptedFrame& frame, int steps) const {
        Workshop shop(in256Rows(problem));
        PoseSearch::Quality quality;
        const auto fit = [&](std::vector<double>& dofs, double stiffness) {
            shop.fit.run(shop.energy, dofs, steps, stiffness);
            quality = PoseSearch::measure(shop.problem, dofs);
        };
        fit(frame.dofs, 1);
        for (const double stiffness : kMending) {
            if (quality.isValid()) break;
            fit(frame.dofs, stiffness);
        }
        if (!quality.isValid()) {
            // An actor whom no fit brings back into balance is searched on his own.
            Rng rng(streamSeed(seed_, {Stream::Mending, i}));
            for (std::size_t a = 0; a < quality.actors.size(); ++a) {
                if (quality.actors[a].isValid()) continue;
                std::vector<std::size_t> his(problem.actors[a].dofs);
                std::iota(his.begin(), his.end(), problem.firstDof(a));
                shop.search.run(shop.energy, frame.dofs, his, kAlone, rng);
                fit(frame.dofs, kMending.back());
            }
            // Stiff physics cost some of the match. It is regained with softer physics as long as
            // everyone stands.
            std::vector<double> relaxed = frame.dofs;
            for (const double stiffness : kRelaxing) {
                if (!quality.isValid()) break;
                frame.dofs = relaxed;
                fit(relaxed, stiffness);
            }
            if (quality.isValid()) frame.dofs = relaxed;
        }
        frame.quality = PoseSearch::measure(problem, frame.dofs);
        frame.evaluations += shop.evaluations();
    }

    // Fits every frame but the representative one between both its neighbours: first the even
    // frames, then the odd ones.
    void settle() {
        for (std::size_t parity = 0; parity < 2; ++parity) {
            std::vector<std::size_t> which;
            for (std::size_t i = parity; i < frames_.size(); i += 2)
                if (i != motion_.representative) which.push_back(i);
            parallelFor(static_cast<int>(which.size()), options_.threads, [&](int k) {
                const std::size_t i = which[static_cast<std::size_t>(k)];
                if (!mustStop()) keep(i, settled(i));
            });
        }
    }

    // The neighbours of a frame. In a loop of an odd number of frames, the first and the last frame
    // are processed at the same time, so neither is the other's neighbour.
    std::vector<std::size_t> neighboursOf(std::size_t i) const {
        const std::size_t last = frames_.size() - 1;
        const bool isRound = motion_.loops && last % 2 == 1;
        std::vector<std::size_t> neighbours;
        if (i > 0 || isRound) neighbours.push_back(i > 0 ? i - 1 : last);
        if (i < last || isRound) neighbours.push_back(i < last ? i + 1 : 0);
        return neighbours;
    }

    // Fits a frame from its own poses. If a neighbour matches clearly better, or only the neighbour
    // is valid, the frame is also fitted from the neighbour's poses, on either side.
    AdaptedFrame settled(std::size_t i) const {
        const std::vector<std::size_t> neighbours = neighboursOf(i);
        PoseProblem problem = problemAt(i);
        for (const std::size_t neighbour : neighbours) addNeighbour(problem, *frames_[neighbour]);
        AdaptedFrame best = *frames_[i];
        best.quality = PoseSearch::measure(problem, best.dofs);
        std::int64_t evaluations = best.evaluations;
        const auto offer = [&](AdaptedFrame other) {
            finish(i, problem, other, kPassSteps);
            evaluations += other.evaluations;
            if (isBetter(other.quality, best.quality)) best = std::move(other);
        };
        offer({{}, best.dofs, {}, 0});
        for (const std::size_t neighbour : neighbours) {
            const PoseSearch::Quality& there = frames_[neighbour]->quality;
            if (there.iou < best.quality.iou + kClearlyLess && !(there.isValid() && !best.quality.isValid())) continue;
            AdaptedFrame other{{}, frames_[neighbour]->dofs, {}, 0};
            walk(neighbour, i, other);
            offer(std::move(other));
        }
        best.evaluations = evaluations;
        return best;
    }
    static bool isBetter(const PoseSearch::Quality& a, const PoseSearch::Quality& b) {
        return a.isValid() != b.isValid() ? a.isValid() : a.energy < b.energy;
    }

    const MotionProblem& motion_;
    std::uint64_t seed_;
    const MotionAdaptation::Options& options_;
    const AdaptationWatch& watch_;
    MotionAdaptation::Frames frames_;
    std::vector<std::vector<GeneralisedCone::Coordinates>> coordinates_;  // C_n^0, of each actor's joints
    std::vector<Continuity> continuity_;                                  // without neighbours
    std::mutex mutex_;  // guards isStopped_, the watch, and the storing of frames
    bool isStopped_ = false;
};

}  // namespace

MotionAdaptation::Frames MotionAdaptation::run(const MotionProblem& problem, std::span<const double> dofs, std::uint64_t seed,
                                               const Options& options, const AdaptationWatch& watch, Frames known) {
    FANTASCOPE_CHECK(problem.representative < problem.targets.size() && problem.corners.size() == problem.targets.size(),
                     "each frame has a target and an interior");
    return Adaptation(problem, dofs, seed, options, watch, std::move(known)).run();
}

MotionQuality measureMotion(const MotionProblem& problem, const MotionAdaptation::Frames& frames, double framesPerSecond) {
    MotionQuality quality;
    const PoseProblem& principal = problem.principal;
    PosedBody posed;
    for (std::size_t a = 0; a < principal.actors.size(); ++a) {
        const Body& body = principal.actors[a];
        const auto ownOf = [&](std::size_t frame) {
            return std::span(frames[frame]->dofs).subspan(principal.firstDof(a), body.dofs);
        };
        posed.pose(body, ownOf(problem.representative));
        const auto contacts = bearingParts(body, principal.stage, posed);
        for (std::size_t i = 0; i < frames.size(); ++i) {
            if (!frames[i]) continue;
            posed.pose(body, ownOf(i));
            for (const HeldContact& contact : contacts)
                quality.farthestContact =
                    std::max(quality.farthestContact, glm::distance(posed.place(contact.joint), contact.place));
            const std::size_t next = i + 1 < frames.size() ? i + 1 : 0;
            if ((next == 0 && !problem.loops) || !frames[next]) continue;
            const ActorPose here = poseOf(body, ownOf(i)), there = poseOf(body, ownOf(next));
            quality.fastestRoot = std::max(quality.fastestRoot, framesPerSecond * glm::distance(here.root, there.root));
            for (std::size_t k = 0; k < here.turns.size(); ++k)
                quality.fastestJoint =
                    std::max(quality.fastestJoint, framesPerSecond * glm::length(turnBetween(here.turns[k], there.turns[k])));
        }
    }
    return quality;
}

}  // namespace fantascope::theatre
