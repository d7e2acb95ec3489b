#include "theatre/energy/scene_energy.h"

#include "theatre/energy/energy_terms.h"

#include "core/check.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fantascope::theatre {

SceneEnergy::SceneEnergy(const PoseProblem& problem) : problem_(problem), actors_(problem.actors.size()) {
    FANTASCOPE_CHECK(problem.targets.size() == problem.stage.beams.size(), "each beam of a stage has a target");
    placeStanding(problem.stage, standing_);
    for (std::size_t i = 0; i < problem.targets.size(); ++i) beams_.emplace_back(problem, i, standing_);
    depthsInOthers_.resize(actors_.size() * actors_.size());
}

void SceneEnergy::pose(std::span<const double> dofs, double stiffness) {
    stiffness_ = stiffness;
    bearingDepth_ = kBearingDepth / std::sqrt(stiffness);
    for (std::size_t i = 0; i < actors_.size(); ++i) {
        pose(i, dofs.first(problem_.actors[i].dofs));
        dofs = dofs.subspan(problem_.actors[i].dofs);
    }
}

void SceneEnergy::pose(std::size_t index, std::span<const double> dofs) {
    const Body& body = problem_.actors[index];
    Actor& actor = actors_[index];
    actor.body.pose(body, dofs);
    actor.hasMoved = true;
    const Stage& stage = problem_.stage;
    const auto spheres = overFloor(stage, actor.body.spheres(), actor.aboveGround);
    if (problem_.skins.empty()) {
        findBearings(spheres, bearingDepth_, actor.contacts);
    } else {
        const BodyMesh& mesh = *problem_.skins[index];
        mesh.skin(body, actor.body, actor.skin);
        const auto vertices = overFloor(stage, actor.skin, actor.skinAboveGround);
        findBearings(vertices, mesh.edges, bearingDepth_, actor.contacts);
    }
    actor.margin = actor.contacts.support.margin(actor.body.massCentre());
    actor.own = {};
    actor.own.visible = unseenScreen(body, actor.body);
    actor.own.floor = 1000 * std::max(0.0, actor.contacts.lowest);
    actor.own.supportArea = 1e4 * std::max(0.0, kAmpleArea - actor.contacts.support.area());
    actor.own.margin = lackOfMargin(actor.margin);
    actor.own.people = depthInItself(body, actor.body);
    actor.outside = farthestOutside(stage, actor.contacts);
    placeHeld(stage, index, body, actor.body, actor.held);
    for (BeamEnergy& beam : beams_) beam.pose(index, actor.body, actor.skin, actor.held);
    findIntrusions(stage, standing_, body, actor.body, actor.held, actor.intrusions);
    actor.own.stageSet = depthInStage(stage, actor.body) + squaredDepths(actor.intrusions) + 1e6 * actor.outside * actor.outside;
    matchHints(problem_.hints, problem_.targets[0].frame, index, body, actor.body, actor.matches);
    if (problem_.continuity.empty()) return;
    const Continuity& others = problem_.continuity[index];
    for (const ActorPose& beside : others.neighbours) actor.own.smooth += poseDifference(body, dofs, beside);
    if (others.principal) actor.own.regular = poseDifference(body, dofs, *others.principal);
    const ContactDrift drift = contactDrift(others.contacts, actor.body);
    actor.own.contactPlace = drift.place;
    actor.own.contactTurn = drift.turn;
}

// Equation 5, for the screen whose middle is nearest to the cone of sight.
double SceneEnergy::unseenScreen(const Body& body, const PosedBody& posed) const {
    const glm::dvec3 eyes = posed.point(body.head, body.eyes), gaze = posed.turn(body.head) * body.gaze;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < beams_.size(); ++i) {
        const ScreenFrame& frame = problem_.targets[i].frame;
        const Screen& screen = problem_.stage.screenOf(i);
        const glm::dvec2 middle = frame.metresAt(0.5 * glm::dvec2(frame.width(), frame.height()));
        least = std::min(least, unseen(screen.screenFromStage(eyes), screen.turnedFromStage(gaze), {middle, 0}));
    }
    return least;
}

const EnergyTerms& SceneEnergy::terms() {
    terms_ = {};
    findDepthsInOthers();
    for (std::size_t i = 0; i < actors_.size(); ++i) {
        const Actor& actor = actors_[i];
        terms_.visible += actor.own.visible;
        terms_.floor += actor.own.floor;
        terms_.supportArea += actor.own.supportArea;
        terms_.margin += actor.own.margin;
        terms_.people += actor.own.people;
        terms_.stageSet += actor.own.stageSet;
        terms_.smooth += actor.own.smooth;
        terms_.regular += actor.own.regular;
        terms_.contactPlace += actor.own.contactPlace;
        terms_.contactTurn += actor.own.contactTurn;
        for (std::size_t j = i + 1; j < actors_.size(); ++j) terms_.people += depthsInOthers_[i * actors_.size() + j];
        if (actor.held.empty()) continue;
        for (std::size_t j = 0; j < actors_.size(); ++j) {
            if (j == i) continue;
            findIntrusions(problem_.actors[j], actors_[j].body, actor.held, inOthersProps_);
            terms_.stageSet += squaredDepths(inOthersProps_);
        }
    }
    for (BeamEnergy& beam : beams_) beam.addTo(terms_);
    const double square256 = problem_.targets[0].refPixelsPerPixel * problem_.targets[0].refPixelsPerPixel;
    for (std::size_t i = 0; i < problem_.hints.size(); ++i) terms_.hint += square256 * hintOwner(i).match.square;
    return terms_;
}

void SceneEnergy::findDepthsInOthers() {
    for (std::size_t i = 0; i < actors_.size(); ++i)
        for (std::size_t j = i + 1; j < actors_.size(); ++j)
            if (actors_[i].hasMoved || actors_[j].hasMoved)
                depthsInOthers_[i * actors_.size() + j] = depthInOther(actors_[i].body, actors_[j].body);
    for (Actor& actor : actors_) actor.hasMoved = false;
}

std::vector<SceneEnergy::Thing> SceneEnergy::things() const {
    std::vector<Thing> things;
    for (const Stage::Platform& platform : problem_.stage.platforms) things.push_back({platform.name, meshOf(platform)});
    for (const PlacedProp& prop : standing_) things.push_back({prop.prop->name, meshOf(prop)});
    for (const Actor& actor : actors_)
        for (const PlacedProp& prop : actor.held) things.push_back({prop.prop->name, meshOf(prop)});
    return things;
}

SceneEnergy::HintOwner SceneEnergy::hintOwner(std::size_t hint) const {
    HintOwner nearest{0, actors_[0].matches[hint]};
    for (std::size_t i = 1; i < actors_.size(); ++i)
        if (actors_[i].matches[hint].square < nearest.match.square) nearest = {i, actors_[i].matches[hint]};
    return nearest;
}

}  // namespace fantascope::theatre
