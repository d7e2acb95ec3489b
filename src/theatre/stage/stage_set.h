#pragma once

#include "theatre/body/balance.h"
#include "theatre/body/body.h"
#include "theatre/body/posed_body.h"
#include "theatre/mask/bit_mask.h"
#include "theatre/stage/stage.h"

#include <optional>
#include <span>
#include <vector>

namespace fantascope::theatre {

// What stands on a stage besides people, and what they hold: Won & Lee 2016, equation 6, the ground
// of DistFloor and E_k beyond floor and screen. On a stage with none of it all of this costs
// nothing. Metres, stage frame. Thread: reentrant.

// The spheres as if each stood over the floor: lowered by the height of what is under it. `scratch`
// keeps those of a stage with platforms.
std::span<const PlacedSphere> overFloor(const Stage& stage, std::span<const PlacedSphere> spheres,
                                        std::vector<PlacedSphere>& scratch);
std::span<const glm::vec3> overFloor(const Stage& stage, std::span<const glm::vec3> points, std::vector<glm::vec3>& scratch);

// How far the farthest of what bears is outside the stage's standing area.
double farthestOutside(const Stage& stage, const Contacts& contacts);

// A prop in its place.
struct PlacedProp {
    const Prop* prop = nullptr;
    std::uint32_t joint = 0;  // of the holder
    glm::dvec3 place{0};
    glm::dquat turn{1, 0, 0, 0};

    glm::dvec3 point(const glm::dvec3& local) const { return place + turn * local; }
};
void placeStanding(const Stage& stage, std::vector<PlacedProp>& props);
// Those that an actor holds.
void placeHeld(const Stage& stage, std::size_t actor, const Body& body, const PosedBody& posed, std::vector<PlacedProp>& props);

// One place where a body, or what it holds, is in something.
struct Intrusion {
    std::uint32_t joint = 0;  // of the body's capsule; of one who holds what intrudes
    glm::dvec3 point{0};      // fixed to it
    glm::dvec3 outward{0};    // the way out, unit
    double depth = 0;         // metres, > 0
    std::optional<std::uint32_t>
        otherJoint;  // what it intrudes on moves with this joint: of the same body, or of the prop's holder
};
// Of each of a body's capsules in each platform, standing prop and prop that it holds itself (but
// for the joint that holds it and its neighbours), the deepest; and of each prop that it holds, in
// floor, screens and each platform.
void findIntrusions(const Stage& stage, std::span<const PlacedProp> standing, const Body& body, const PosedBody& posed,
                    std::span<const PlacedProp> held, std::vector<Intrusion>& intrusions);
// Of each of a body's capsules in each prop that another holds.
void findIntrusions(const Body& body, const PosedBody& posed, std::span<const PlacedProp> heldByOther,
                    std::vector<Intrusion>& intrusions);
// The squares of their depths, square millimetres; and the greatest depth, metres.
double squaredDepths(std::span<const Intrusion> intrusions);
double deepest(std::span<const Intrusion> intrusions);

// What they look like.
TriangleMesh meshOf(const Stage::Platform& platform);
TriangleMesh meshOf(const PlacedProp& prop);
// Adds the shadow of such a mesh to a mask of the frame's size: of each of its faces that is nearer
// to the screen than the light.
void addShadow(const ScreenFrame& frame, const TriangleMesh& mesh, BitMask& mask);
// Blackens what a beam's projector does not light: there is no shadow in the dark.
void cutToLit(const Stage& stage, const ScreenFrame& frame, BitMask& mask, std::size_t beam = 0);

}  // namespace fantascope::theatre
