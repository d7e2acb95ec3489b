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

// The stage set and the props that people hold. In Won & Lee 2016, equation 6, these are the ground
// of DistFloor, and E_k beyond floor and screen. On a stage without platforms and props, all of
// this costs nothing. Metres, stage frame. Thread: reentrant.

// Spheres or points with their heights measured from the ground: each is lowered by the height of
// the ground under it. On a stage with platforms the result is in `scratch`.
std::span<const PlacedSphere> overFloor(const Stage& stage, std::span<const PlacedSphere> spheres,
                                        std::vector<PlacedSphere>& scratch);
std::span<const glm::vec3> overFloor(const Stage& stage, std::span<const glm::vec3> points, std::vector<glm::vec3>& scratch);

// The greatest distance of a contact outside the stage's standing area, metres.
double farthestOutside(const Stage& stage, const Contacts& contacts);

// A prop in its place.
struct PlacedProp {
    const Prop* prop = nullptr;
    std::uint32_t joint = 0;  // of the holder that carries it
    glm::dvec3 place{0};
    glm::dquat turn{1, 0, 0, 0};

    glm::dvec3 point(const glm::dvec3& local) const { return place + turn * local; }
};
void placeStanding(const Stage& stage, std::vector<PlacedProp>& props);
// Places the props that an actor holds.
void placeHeld(const Stage& stage, std::size_t actor, const Body& body, const PosedBody& posed, std::vector<PlacedProp>& props);

// A place where a body, or a prop that it holds, penetrates an obstacle.
struct Intrusion {
    std::uint32_t joint = 0;  // of the intruding capsule, or of the intruding prop's holder
    glm::dvec3 point{0};      // fixed to `joint`, stage frame
    glm::dvec3 outward{0};    // the way out, unit
    double depth = 0;         // metres, > 0
    std::optional<std::uint32_t>
        otherJoint;  // the joint that the obstacle moves with, of the same body or of the prop's holder; none: it stands still
};
// Finds the deepest intrusion of each capsule of a body into each platform, each standing prop and
// each prop that the body holds itself, except for the joint that holds it and adjacent joints.
// Also of each held prop into the floor, the screens and each platform.
void findIntrusions(const Stage& stage, std::span<const PlacedProp> standing, const Body& body, const PosedBody& posed,
                    std::span<const PlacedProp> held, std::vector<Intrusion>& intrusions);
// Finds the deepest intrusion of each capsule of a body into each prop that another actor holds.
void findIntrusions(const Body& body, const PosedBody& posed, std::span<const PlacedProp> heldByOther,
                    std::vector<Intrusion>& intrusions);
// The sum of the squared depths, square millimetres; and the greatest depth, metres.
double squaredDepths(std::span<const Intrusion> intrusions);
double deepest(std::span<const Intrusion> intrusions);

// Their meshes, in the stage's frame, metres.
TriangleMesh meshOf(const Stage::Platform& platform);
TriangleMesh meshOf(const PlacedProp& prop);
// Adds the shadow of such a mesh to a mask of the frame's size. A face counts only if all its
// corners are nearer to the screen than the light.
void addShadow(const ScreenFrame& frame, const TriangleMesh& mesh, BitMask& mask);
// Blackens the part of a mask that a beam's projector does not light, since there is no shadow in
// the dark.
void cutToLit(const Stage& stage, const ScreenFrame& frame, BitMask& mask, std::size_t beam = 0);

}  // namespace fantascope::theatre
