#include "theatre/scene_energy.h"

#include "theatre/energy_terms.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope::theatre {

SceneEnergy::SceneEnergy(const PoseProblem& problem)
    : problem_(problem), disc_(std::max(1.0, kDiscRadius / problem.target.pixelsOf256)), actors_(problem.actors.size()) {
    const BitMask& mask = problem.target.mask;
    shadow_ = shadowBefore_ = BitMask(mask.width(), mask.height());
    for (Actor& actor : actors_) actor.shadow = shadow_;
    placeStanding(problem.stage, standing_);
    if (!standing_.empty() || !problem.stage.platforms.empty()) standingShadow_ = shadow_;
    for (const Stage::Platform& platform : problem.stage.platforms)
        addShadow(problem.target.frame, meshOf(platform), standingShadow_);
    for (const PlacedProp& prop : standing_) addShadow(problem.target.frame, meshOf(prop), standingShadow_);
    cutToLit(problem.stage, problem.target.frame, standingShadow_);
    nearest_.resize(problem.target.contour.size());
    owners_.resize(nearest_.size());
    depthsInOthers_.resize(actors_.size() * actors_.size());
}

void SceneEnergy::pose(std::span<const double> freedoms) {
    for (std::size_t i = 0; i < actors_.size(); ++i) {
        pose(i, freedoms.first(problem_.actors[i].freedoms));
        freedoms = freedoms.subspan(problem_.actors[i].freedoms);
    }
}

void SceneEnergy::pose(std::size_t index, std::span<const double> freedoms) {
    const Body& body = problem_.actors[index];
    Actor& actor = actors_[index];
    actor.body.pose(body, freedoms);
    actor.hasMoved = true;
    actor.shadow.clear();
    const Stage& stage = problem_.stage;
    const auto spheres = overFloor(stage, actor.body.spheres(), actor.aboveGround);
    if (problem_.skins.empty()) {
        capsuleShadow_.add(problem_.target.frame, actor.body, actor.shadow);
        findBearings(spheres, problem_.weights.bearing, actor.contacts);
    } else {
        const BodyMesh& mesh = *problem_.skins[index];
        mesh.skin(body, actor.body, actor.skin);
        meshShadow_.add(problem_.target.frame, mesh, actor.skin, actor.shadow);
        const auto vertices = overFloor(stage, actor.skin, actor.skinAboveGround);
        findBearings(vertices, mesh.edges, problem_.weights.bearing, actor.contacts);
    }
    cutToLit(stage, problem_.target.frame, actor.shadow);
    actor.margin = supportMargin(actor.contacts, actor.body.massCentre());
    const ScreenFrame& frame = problem_.target.frame;
    const glm::dvec2 middle = frame.metresAt(0.5 * glm::dvec2(frame.width(), frame.height()));
    actor.own = {};
    actor.own.visible = unseen(actor.body.point(body.head, body.eyes), actor.body.turn(body.head) * body.gaze, {middle, 0});
    actor.own.floor = 1000 * std::max(0.0, actor.contacts.lowest);
    actor.own.supportArea = 1e4 * std::max(0.0, kAmpleArea - supportArea(actor.contacts));
    actor.own.margin = lackOfMargin(actor.margin);
    actor.own.people = depthInItself(body, actor.body);
    actor.outside = farthestOutside(stage, actor.contacts);
    poseProps(index);
    findIntrusions(stage, standing_, body, actor.body, actor.held, actor.intrusions);
    actor.own.surroundings = depthInStage(actor.body) + squaredDepths(actor.intrusions) + 1e6 * actor.outside * actor.outside;
    matchHints(problem_.hints, frame, index, body, actor.body, actor.matches);
    if (problem_.continuity.empty()) return;
    const Continuity& others = problem_.continuity[index];
    for (const ActorPose& beside : others.neighbours) actor.own.smooth += poseDifference(body, freedoms, beside);
    if (others.principal) actor.own.regular = poseDifference(body, freedoms, *others.principal);
    const ContactDrift drift = contactDrift(others.contacts, actor.body);
    actor.own.contactPlace = drift.place;
    actor.own.contactTurn = drift.turn;
}

void SceneEnergy::poseProps(std::size_t index) {
    Actor& actor = actors_[index];
    placeHeld(problem_.stage, index, problem_.actors[index], actor.body, actor.held);
    if (actor.held.empty()) return;
    if (actor.heldShadow.width() == 0) actor.heldShadow = BitMask(shadow_.width(), shadow_.height());
    actor.heldShadow.clear();
    for (const PlacedProp& prop : actor.held) addShadow(problem_.target.frame, meshOf(prop), actor.heldShadow);
    cutToLit(problem_.stage, problem_.target.frame, actor.heldShadow);
}

const EnergyTerms& SceneEnergy::terms() {
    terms_ = {};
    findDepthsInOthers();
    std::swap(shadow_, shadowBefore_);
    shadow_.clear();
    if (standingShadow_.width() > 0) shadow_.add(standingShadow_);
    for (std::size_t i = 0; i < actors_.size(); ++i) {
        const Actor& actor = actors_[i];
        shadow_.add(actor.shadow);
        terms_.visible += actor.own.visible;
        terms_.floor += actor.own.floor;
        terms_.supportArea += actor.own.supportArea;
        terms_.margin += actor.own.margin;
        terms_.people += actor.own.people;
        terms_.surroundings += actor.own.surroundings;
        terms_.smooth += actor.own.smooth;
        terms_.regular += actor.own.regular;
        terms_.contactPlace += actor.own.contactPlace;
        terms_.contactTurn += actor.own.contactTurn;
        for (std::size_t j = i + 1; j < actors_.size(); ++j) terms_.people += depthsInOthers_[i * actors_.size() + j];
        if (actor.held.empty()) continue;
        shadow_.add(actor.heldShadow);
        for (std::size_t j = 0; j < actors_.size(); ++j) {
            if (j == i) continue;
            findIntrusions(problem_.actors[j], actors_[j].body, actor.held, inOthersProps_);
            terms_.surroundings += squaredDepths(inOthersProps_);
        }
    }
    terms_.coverage = static_cast<double>(differing(shadow_, problem_.target.mask)) / problem_.target.area;
    compareContours();
    const double square256 = problem_.target.pixelsOf256 * problem_.target.pixelsOf256;
    for (std::size_t i = 0; i < problem_.hints.size(); ++i) terms_.hint += square256 * hintOwner(i).match.square;
    terms_.coherence = ownerChanges(owners_);
    return terms_;
}

void SceneEnergy::findDepthsInOthers() {
    for (std::size_t i = 0; i < actors_.size(); ++i)
        for (std::size_t j = i + 1; j < actors_.size(); ++j)
            if (actors_[i].hasMoved || actors_[j].hasMoved)
                depthsInOthers_[i * actors_.size() + j] = depthInOther(actors_[i].body, actors_[j].body);
    for (Actor& actor : actors_) actor.hasMoved = false;
}

BitMask SceneEnergy::propShadow() const {
    BitMask shadow(shadow_.width(), shadow_.height());
    if (standingShadow_.width() > 0) shadow.add(standingShadow_);
    for (const Actor& actor : actors_)
        if (!actor.held.empty()) shadow.add(actor.heldShadow);
    return shadow;
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

// Whether a target's point has the nearest point that it had: no contour pixel as near has come or gone, which takes a change of the pixel
// or of a neighbour, and nothing by which the nearest is measured has changed.
bool SceneEnergy::isAsBefore(std::size_t point) const {
    if (!hasNearest_) return false;
    if (!changes_.isAny()) return true;
    const glm::ivec2 wanted = problem_.target.contour[point].pixel, got = nearest_[point].pixel;
    const int away = static_cast<int>(std::ceil(glm::distance(glm::dvec2(wanted), glm::dvec2(got))));
    return !changes_.mayReach(wanted, away + 1) && !changes_.mayReach(got, disc_.radius());
}

// Equation 2, from the target's contour to the nearest points of the shadow's. Whose (equation 4): the actor whose shadow holds that point; of
// several the one whose the last point was, else the first; nobody if it is a prop's.
void SceneEnergy::compareContours() {
    const PoseTarget& target = problem_.target;
    const double scale = target.pixelsOf256 * target.pixelsOf256, each = target.perPoint();
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
            // No shadow at all: as far as the picture is wide.
            terms_.contourPoint += each * scale * target.mask.width() * target.mask.width();
            nearest_[i] = {};
        }
        if (pixel) {
            const ContourPoint& got = nearest_[i];
            const glm::dvec2 away = wanted.pixel - got.pixel, turned = wanted.normal - got.normal;
            const double bent = wanted.curvature - got.curvature;
            terms_.contourPoint += each * scale * glm::dot(away, away);
            terms_.contourNormal += each * glm::dot(turned, turned);
            terms_.contourCurvature += each * bent * bent;
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
