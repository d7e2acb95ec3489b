#include "theatre/pose_search.h"

#include "theatre/energy_terms.h"
#include "theatre/freedom_search.h"
#include "theatre/scene_energy.h"
#include "theatre/silhouette_fit.h"

#include "core/parallel.h"
#include "core/random.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace fantascope::theatre {
namespace {

// The streams of random numbers of a trial (core/random.h).
enum class Stream : std::uint64_t { Trial = 1, Moves = 2 };

constexpr double kGlobalShare = 0.15;            // of the evaluations, in pixels of twice the side
constexpr double kCoarseShare = 0.8;             // so far they are used; the rest sees every pixel
constexpr double kWeak = 0.01, kLessWeak = 0.1;  // stiffness at the beginning and at the end of the global stage
constexpr double kGlobalSigma = 0.5;
constexpr std::array kStiffer = {0.01, 0.03, 0.1};  // while the outline is fitted
constexpr double kHeld = 0.1,
                 kHeldBy = 0.87;  // at the beginning of the coarse local search, and the share of it by which it is 1
constexpr std::array kMending = {2.0, 4.0, 8.0};  // at the end, while somebody cannot stand
constexpr int kFitSteps = 20, kRefitSteps = 20, kLastFitSteps = 60;
// How much energy a change may cost at the beginning of the local search, and the share of it at the end.
constexpr double kHot = 6, kCool = 0.05;

class TrialRun {
public:
    TrialRun(const PoseProblem& problem, std::uint64_t seed, const PoseSearch::Options& options,
             const PoseSearch::AskStop& askStop)
        : options_(options),
          askStop_(askStop),
          fine_(in256Rows(problem)),
          coarse_(halvedCapsules(fine_.problem)),
          rng_(streamSeed(seed, {static_cast<std::uint64_t>(Stream::Moves)})) {
        trial_.seed = seed;
        trial_.reason = PoseSearch::StopReason::Evaluations;
        trial_.freedoms = PoseSearch::start(problem);
    }

    PoseSearch::Trial run() {
        searchGlobally(coarse_);
        stiffen(coarse_);
        searchLocally(coarse_, kCoarseShare, kHeld);
        searchLocally(fine_, 1, 1);
        fine_.fit.run(fine_.energy, trial_.freedoms, kLastFitSteps);
        for (const double stiffness : kMending) {
            if (trial_.reason == PoseSearch::StopReason::Interrupted ||
                PoseSearch::measure(fine_.problem, trial_.freedoms).isValid())
                break;
            fine_.setStiffness(stiffness);
            fine_.fit.run(fine_.energy, trial_.freedoms, kFitSteps);
        }
        trial_.evaluations = evaluations();
        return std::move(trial_);
    }

private:
    // A problem of its own, since the stiffness changes, and what works on it.
    struct Workshop {
        explicit Workshop(PoseProblem given) : problem(std::move(given)), energy(problem), search(problem), fit(problem) {}
        std::int64_t evaluations() const { return search.evaluations() + fit.evaluations(); }
        // What is not stiff is not sharp either: a foot far above the ground bears a little.
        void setStiffness(double stiffness) {
            problem.weights.stiffness = stiffness;
            problem.weights.bearing = PoseWeights().bearing / std::sqrt(stiffness);
        }

        PoseProblem problem;
        SceneEnergy energy;
        FreedomSearch search;
        SilhouetteFit fit;
    };
    std::int64_t evaluations() const { return fine_.evaluations() + coarse_.evaluations(); }

    bool goesOn(double energy) {
        if (trial_.reason != PoseSearch::StopReason::Interrupted && askStop_ && askStop_({evaluations(), energy}))
            trial_.reason = PoseSearch::StopReason::Interrupted;
        return trial_.reason != PoseSearch::StopReason::Interrupted;
    }

    void searchGlobally(Workshop& shop) {
        std::vector<std::size_t> all(trial_.freedoms.size());
        std::iota(all.begin(), all.end(), std::size_t{0});
        const int generations =
            std::max(1, static_cast<int>(kGlobalShare * static_cast<double>(options_.evaluations) / options_.population));
        shop.search.run(shop.energy, trial_.freedoms, all, {kGlobalSigma, options_.population, generations}, rng_,
                        [&](int generation) {
                            shop.setStiffness(kWeak * std::pow(kLessWeak / kWeak, double(generation) / generations));
                            return goesOn(shop.energy.lastEnergy());
                        });
    }

    static PoseProblem in256Rows(PoseProblem problem) {
        while (problem.target.pixelsOf256 < 1) problem.target = problem.target.halved(problem.stage);
        return problem;
    }
    static PoseProblem halvedCapsules(PoseProblem problem) {
        problem.target = problem.target.halved(problem.stage);
        problem.skins.clear();
        return problem;
    }

    // The outline first, then a little more of standing.
    void stiffen(Workshop& shop) {
        for (const double stiffness : kStiffer) {
            shop.setStiffness(stiffness);
            shop.fit.run(shop.energy, trial_.freedoms, kFitSteps);
        }
    }

    // Iterated local search until a share of the evaluations is spent, while physics becomes what holds people up.
    void searchLocally(Workshop& shop, double share, double stiffness) {
        const auto first = evaluations(), last = static_cast<std::int64_t>(share * static_cast<double>(options_.evaluations));
        std::vector<double> here = trial_.freedoms, next;
        double best = std::numeric_limits<double>::infinity();
        while (evaluations() < last) {
            const double done = double(evaluations() - first) / double(last - first);
            shop.setStiffness(std::pow(stiffness, std::max(0.0, 1 - done / kHeldBy)));
            shop.energy.pose(here);
            double current = shop.energy.energy();
            if (!goesOn(current)) break;

            next = here;
            change(shop, next);
            const double found = shop.fit.run(shop.energy, next, kRefitSteps);
            const double progress = double(evaluations()) / double(options_.evaluations);
            const double tolerance = -kHot * std::pow(kCool, progress) * std::log(1 - rng_.uniform());
            if (found < current + tolerance) here = next, current = found;
            // While physics stiffens energies cannot be compared: the newest is the best.
            if (stiffness < 1 || current < best) best = current, trial_.freedoms = here;
            trial_.history.push_back(best);
        }
        shop.setStiffness(1);
    }

    // One actor anew, one of his limbs, or a step in the dark.
    void change(Workshop& shop, std::vector<double>& freedoms) {
        const auto& actors = shop.problem.actors;
        const std::size_t actor = rng_.below(static_cast<std::uint32_t>(actors.size()));
        const Body& body = actors[actor];
        std::size_t first = 0;
        for (std::size_t i = 0; i < actor; ++i) first += actors[i].freedoms;
        std::vector<std::size_t> which;
        const double kind = rng_.uniform();
        if (kind < 0.4) {
            for (std::size_t k = 0; k < body.freedoms; ++k) which.push_back(first + k);
            shop.search.run(shop.energy, freedoms, which, {0.3, 16, 10}, rng_);
        } else if (kind < 0.8) {
            for (const std::size_t k : limb(body, 1 + rng_.below(static_cast<std::uint32_t>(body.joints.size() - 1))))
                which.push_back(first + k);
            shop.search.run(shop.energy, freedoms, which, {0.8, 12, 8}, rng_);
        } else {
            const auto own = std::span(freedoms).subspan(first, body.freedoms);
            for (std::size_t k = 0; k < own.size(); ++k) own[k] += 0.4 * Body::scaleOf(k) * rng_.normal();
            body.limit(own);
        }
    }

    // The freedoms of a joint, of all that hang on it, and of the one that it hangs on.
    static std::vector<std::size_t> limb(const Body& body, std::size_t joint) {
        std::vector<char> in(body.joints.size(), 0);
        in[joint] = 1;
        for (std::size_t i = joint + 1; i < in.size(); ++i) in[i] = in[body.joints[i].parent];
        if (body.joints[joint].parent != 0) in[body.joints[joint].parent] = 1;
        std::vector<std::size_t> freedoms;
        for (std::size_t i = 1; i < in.size(); ++i)
            for (std::size_t k = 0; in[i] != 0 && k < body.joints[i].motion.size(); ++k)
                freedoms.push_back(body.joints[i].first + k);
        return freedoms;
    }

    const PoseSearch::Options& options_;
    const PoseSearch::AskStop& askStop_;
    Workshop fine_, coarse_;
    Rng rng_;
    PoseSearch::Trial trial_;
};

bool isWithinLimits(const Body& body, std::span<const double> freedoms) {
    constexpr double kRounding = 1e-6;
    for (std::size_t i = 1; i < body.joints.size(); ++i) {
        const JointMotion& motion = body.joints[i].motion;
        const glm::dquat orientation = motion.orientation(freedoms.subspan(body.joints[i].first, motion.size()));
        for (const JointLimit& limit : motion.limits()) {
            const double measure = limit.measure(orientation);
            if (measure < limit.low - kRounding || measure > limit.high + kRounding) return false;
        }
    }
    return true;
}

}  // namespace

std::string_view name(PoseSearch::StopReason reason) {
    switch (reason) {
        case PoseSearch::StopReason::NotRun:
            return "not_run";
        case PoseSearch::StopReason::Evaluations:
            return "evaluations";
        case PoseSearch::StopReason::Interrupted:
            return "interrupted";
    }
    return "";
}

Result<void> PoseSearch::Options::check() const {
    if (evaluations < 1000) return Error(fmt::format("evaluations: {} are too few for a trial, take 1000 or more", evaluations));
    if (population < 4 || population > 1000)
        return Error(fmt::format("population: {} is out of range, 4 .. 1000 is allowed", population));
    return {};
}

bool PoseSearch::Quality::isValid() const {
    return std::all_of(actors.begin(), actors.end(), [](const Actor& actor) {
        return actor.touches && actor.margin >= kStandMargin && actor.deepest <= kMostDepth && actor.outside <= kMostDepth &&
               actor.withinLimits;
    });
}

std::vector<double> PoseSearch::start(const PoseProblem& problem) {
    const ScreenFrame& frame = problem.target.frame;
    const double middle = frame.metresAt({0.5 * frame.width(), 0}).x;
    std::vector<double> freedoms;
    const auto count = static_cast<double>(problem.actors.size());
    // However many: near enough to the middle to have the screen's in sight.
    const double apart = std::min(0.6, 3 / count);
    for (std::size_t i = 0; i < problem.actors.size(); ++i) {
        const Body& body = problem.actors[i];
        // Behind each other by the golden section: whoever stands next has his arms before or behind.
        const double share = std::fmod(0.618034 * static_cast<double>(i), 1.0);
        glm::dvec2 floor(middle + apart * (static_cast<double>(i) - 0.5 * (count - 1)), 1 + 1.6 * share);
        if (const auto& area = problem.stage.standing) floor = glm::clamp(floor, area->from, area->to);
        const double ground = problem.stage.groundUnder({floor.x, std::numeric_limits<double>::infinity(), floor.y});
        const glm::dvec3 place(floor.x, ground + body.joints[0].offset.y, floor.y);
        const std::vector<double> pose = body.restPose(place, glm::dquat(0, 0, 1, 0));
        freedoms.insert(freedoms.end(), pose.begin(), pose.end());
    }
    return freedoms;
}

PoseSearch::Trial PoseSearch::run(const PoseProblem& problem, std::uint64_t seed, const Options& options,
                                  const AskStop& askStop) {
    Trial trial = TrialRun(problem, seed, options, askStop).run();
    trial.quality = measure(problem, trial.freedoms);
    return trial;
}

std::uint64_t PoseSearch::trialSeed(std::uint64_t seed, std::uint64_t number) {
    return streamSeed(seed, {static_cast<std::uint64_t>(Stream::Trial), number}) >> 1;
}

std::vector<PoseSearch::Trial> PoseSearch::runTrials(const PoseProblem& problem, std::uint64_t seed, int trials,
                                                     const Options& options, int threads, const AskStop& askStop) {
    std::vector<Trial> found(static_cast<std::size_t>(trials));
    parallelFor(trials, threads, [&](int i) {
        const auto number = static_cast<std::size_t>(i);
        found[number] = run(problem, trialSeed(seed, number), options, askStop);
    });
    return found;
}

PoseSearch::Quality PoseSearch::measure(const PoseProblem& problem, std::span<const double> freedoms) {
    SceneEnergy energy(problem);
    energy.pose(freedoms);
    Quality quality;
    quality.terms = energy.terms();
    quality.energy = quality.terms.total(problem.weights);
    const double shadow = static_cast<double>(energy.shadow().count()), target = problem.target.area;
    const double both = 0.5 * (shadow + target - static_cast<double>(differing(energy.shadow(), problem.target.mask)));
    quality.iou = both / (shadow + target - both);
    for (std::size_t i = 0; i < problem.target.contour.size(); ++i) {
        const double off = problem.target.pixelsOf256 *
                           glm::distance(glm::dvec2(problem.target.contour[i].pixel), glm::dvec2(energy.nearest()[i].pixel));
        quality.contourMean += off / static_cast<double>(problem.target.contour.size());
        quality.contourMost = std::max(quality.contourMost, off);
    }
    Contacts contacts;
    const bool isSkin = !problem.skins.empty();
    std::vector<Intrusion> intrusions;
    for (std::size_t i = 0; i < problem.actors.size(); ++i) {
        const Body& body = problem.actors[i];
        const PosedBody& posed = energy.posed(i);
        if (isSkin)
            findContacts(energy.skinAboveGround(i), problem.skins[i]->edges, contacts);
        else
            findContacts(energy.aboveGround(i), contacts);
        Actor actor{supportMargin(contacts, posed.massCentre()), contacts.touches, contacts.lowest,
                    std::max({deepestInItself(body, posed), deepestInStage(posed), deepest(energy.intrusions(i))}),
                    isWithinLimits(body, freedoms.first(body.freedoms))};
        for (std::size_t j = 0; j < problem.actors.size(); ++j)
            if (j != i) {
                findIntrusions(body, posed, energy.held(j), intrusions);
                actor.deepest = std::max({actor.deepest, deepestInOther(posed, energy.posed(j)), deepest(intrusions)});
            }
        actor.outside = farthestOutside(problem.stage, contacts);
        quality.actors.push_back(actor);
        freedoms = freedoms.subspan(body.freedoms);
    }
    return quality;
}

}  // namespace fantascope::theatre
