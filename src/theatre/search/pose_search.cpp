#include "theatre/search/pose_search.h"

#include "theatre/energy/energy_terms.h"
#include "theatre/energy/scene_energy.h"
#include "theatre/search/paper_method.h"
#include "theatre/search/refined_method.h"
#include "theatre/search/streams.h"

#include "core/random.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

namespace fantascope::theatre {
namespace {

bool isWithinLimits(const Body& body, std::span<const double> dofs) {
    constexpr double kRounding = 1e-6;
    for (std::size_t i = 1; i < body.joints.size(); ++i) {
        const JointMotion& motion = body.joints[i].motion;
        const glm::dquat orientation = motion.orientation(dofs.subspan(body.joints[i].first, motion.size()));
        for (const JointLimit& limit : motion.limits()) {
            const double measure = limit.measure(orientation);
            if (measure < limit.low - kRounding || measure > limit.high + kRounding) return false;
        }
    }
    return true;
}

// Moves a place on the floor to the front of the further screens, with room for outstretched arms.
void keepBeforeScreens(const Stage& stage, glm::dvec2& floor) {
    constexpr double kRoom = 0.8;
    glm::dvec3 outward;
    for (std::size_t i = 1; i < stage.screens.size(); ++i)
        if (const double away = stage.screens[i].distance({floor.x, 0, floor.y}, outward); away < kRoom)
            floor += (kRoom - away) * glm::dvec2(outward.x, outward.z);
}

PoseSearch::Quality::Match matchOf(const BeamEnergy& beam, std::size_t actors) {
    const PoseTarget& target = beam.target();
    const BitMask& wanted = target.maskAsSeen();
    BitMask people(target.mask.width(), target.mask.height());
    for (std::size_t i = 0; i < actors; ++i) people.add(beam.shadow(i));
    PoseSearch::Quality::Match match;
    // Shadow beside the masks counts as a difference, too.
    const auto iou = [&](const BitMask& shadow, const BitMask& silhouette) {
        const auto both = static_cast<double>(shared(shadow, silhouette));
        return both / (both + static_cast<double>(differing(shadow, silhouette)) + beam.beyond());
    };
    match.iou = iou(target.asSeen(beam.shadow()), wanted);
    match.flatIou = iou(beam.shadow(), target.mask);
    match.iouWithoutProps = iou(target.asSeen(people), wanted);
    match.propsCover =
        static_cast<double>(shared(target.asSeen(beam.propShadow()), wanted)) / static_cast<double>(wanted.count());
    for (std::size_t i = 0; i < target.contour.size(); ++i) {
        const double off =
            target.refPixelsPerPixel * glm::distance(glm::dvec2(target.contour[i].pixel), glm::dvec2(beam.nearest()[i].pixel));
        match.contourMean += off / static_cast<double>(target.contour.size());
        match.contourMost = std::max(match.contourMost, off);
    }
    return match;
}

}  // namespace

std::string_view name(PoseSearch::Method method) { return method == PoseSearch::Method::Refined ? "refined" : "paper"; }

std::string_view name(PoseSearch::StopReason reason) {
    switch (reason) {
        case PoseSearch::StopReason::NotRun:
            return "not_run";
        case PoseSearch::StopReason::Evaluations:
            return "evaluations";
        case PoseSearch::StopReason::Satisfied:
            return "satisfied";
        case PoseSearch::StopReason::Interrupted:
            return "interrupted";
    }
    return "";
}

Result<void> PoseSearch::Options::check() const {
    if (evaluations < 1000) return Error(fmt::format("evaluations: {} are too few for a trial, take 1000 or more", evaluations));
    if (population < 4 || population > 1000)
        return Error(fmt::format("population: {} is out of range, 4 .. 1000 is allowed", population));
    if (!(residual >= 0)) return Error(fmt::format("residual: {} is no energy, 0 or more is allowed", residual));
    return {};
}

bool PoseSearch::Actor::isValid() const {
    return touches && margin >= kStandMargin && deepest <= kMostDepth && outside <= kMostDepth && withinLimits;
}

bool PoseSearch::Quality::isValid() const { return std::all_of(actors.begin(), actors.end(), std::mem_fn(&Actor::isValid)); }

std::vector<double> PoseSearch::start(const PoseProblem& problem) {
    const ScreenFrame& frame = problem.targets[0].frame;
    const double middle = frame.metresAt({0.5 * frame.width(), 0}).x;
    std::vector<double> dofs;
    const auto count = static_cast<double>(problem.actors.size());
    // However many there are, all are near enough to the middle to have the screen's middle in
    // sight.
    const double apart = std::min(0.6, 3 / count);
    for (std::size_t i = 0; i < problem.actors.size(); ++i) {
        const Body& body = problem.actors[i];
        // Depths follow the golden ratio, so that neighbours' arms are in front of or behind each
        // other.
        const double share = std::fmod(0.618034 * static_cast<double>(i), 1.0);
        glm::dvec2 floor(middle + apart * (static_cast<double>(i) - 0.5 * (count - 1)), 1 + 1.6 * share);
        if (const auto& area = problem.stage.standing) floor = glm::clamp(floor, area->from, area->to);
        keepBeforeScreens(problem.stage, floor);
        const double ground = problem.stage.groundUnder({floor.x, std::numeric_limits<double>::infinity(), floor.y});
        const glm::dvec3 place(floor.x, ground + body.joints[0].offset.y, floor.y);
        const std::vector<double> pose = body.restPose(place, glm::dquat(0, 0, 1, 0));
        dofs.insert(dofs.end(), pose.begin(), pose.end());
    }
    return dofs;
}

PoseSearch::Trial PoseSearch::run(const PoseProblem& problem, std::uint64_t seed, const Options& options,
                                  const AskStop& askStop) {
    Trial trial = options.method == Method::Paper ? paperMethod(problem, seed, options, askStop)
                                                  : refinedMethod(problem, seed, options, askStop);
    trial.quality = measure(problem, trial.dofs);
    return trial;
}

std::uint64_t PoseSearch::trialSeed(std::uint64_t seed, std::uint64_t number) {
    return streamSeed(seed, {Stream::Trial, number}) >> 1;
}

PoseSearch::Quality PoseSearch::measure(const PoseProblem& problem, std::span<const double> dofs) {
    SceneEnergy energy(problem);
    energy.pose(dofs);
    Quality quality;
    quality.terms = energy.terms();
    quality.energy = quality.terms.total(problem.weights);
    quality.iou = quality.iouWithoutProps = 1;
    for (std::size_t i = 0; i < problem.targets.size(); ++i) {
        const PoseSearch::Quality::Match match = matchOf(energy.beam(i), problem.actors.size());
        quality.iou = std::min(quality.iou, match.iou);
        quality.iouWithoutProps = std::min(quality.iouWithoutProps, match.iouWithoutProps);
        quality.propsCover = std::max(quality.propsCover, match.propsCover);
        quality.contourMean += match.contourMean / static_cast<double>(problem.targets.size());
        quality.contourMost = std::max(quality.contourMost, match.contourMost);
        quality.matches.push_back(match);
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
        Actor actor{contacts.support.margin(posed.massCentre()), contacts.touches, contacts.lowest,
                    std::max({deepestInItself(body, posed), deepestInStage(problem.stage, posed), deepest(energy.intrusions(i)),
                              -contacts.lowest}),
                    isWithinLimits(body, dofs.first(body.dofs))};
        for (std::size_t j = 0; j < problem.actors.size(); ++j)
            if (j != i) {
                findIntrusions(body, posed, energy.held(j), intrusions);
                actor.deepest = std::max({actor.deepest, deepestInOther(posed, energy.posed(j)), deepest(intrusions)});
            }
        actor.outside = farthestOutside(problem.stage, contacts);
        if (contacts.touches)
            for (const Contact& contact : contacts.discs) actor.contacts.push_back(contact.place);
        quality.actors.push_back(actor);
        dofs = dofs.subspan(body.dofs);
    }
    return quality;
}

}  // namespace fantascope::theatre
