#pragma once

#include "theatre/body_mesh.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace fantascope::theatre {

// How a body stands: Won & Lee 2016, equation 6. The support polygon is the convex hull of the discs in which it touches the
// ground; the ground seen from above, (x, z) in metres.
struct Contact {
    glm::dvec2 place{0};
    double radius = 0;
    std::uint32_t source = 0;  // which sphere or vertex it is of
    double share = 1;          // of its place and radius that it has: findBearings()
    glm::dvec3 point{0};       // where it is on the body
    glm::dvec3 along{0};       // of an edge of the skin that is cut there: where the point goes when the edge rises
};

// What is no higher than this above the ground touches it: flesh gives way.
constexpr double kTouch = 0.01;

// The discs where a body touches the floor: of a sphere of radius r whose lowest point is h above it, all that is below kTouch. A
// body that touches nothing has the place of its lowest point, with no radius, and `touches` false.
struct Contacts {
    std::vector<Contact> discs;
    bool touches = false;
    double lowest = 0;  // the height of the lowest point, metres
    std::uint32_t lowestSource = 0;
};
void findContacts(std::span<const PlacedSphere> spheres, Contacts& contacts);
// The same of a skin: what of it is no higher than kTouch, its edges cut there, as discs of no radius, and of those only the ones that make the
// polygon: margin and area are those of all.
void findContacts(std::span<const glm::vec3> vertices, std::span<const MeshEdge> edges, Contacts& contacts);

// The same for a search, without jumps, and as if the lowest point were on the floor: what is kTouch / 2 above it bears, and what is higher bears
// the less the higher it is, up to `bearing` metres more; the less it bears the nearer its disc is to the lowest point, and the smaller.
void findBearings(std::span<const PlacedSphere> spheres, double bearing, Contacts& contacts);
void findBearings(std::span<const glm::vec3> vertices, std::span<const MeshEdge> edges, double bearing, Contacts& contacts);

// Margin(SP_n, COM_n): the signed distance from the mass centre, seen from above, to the boundary of the support polygon, metres; positive
// inside, negative outside. Of one contact, or two, the polygon is the disc, or the band around the line.
double supportMargin(const Contacts& contacts, const glm::dvec3& massCentre);

// Where the boundary is nearest: the polygon's tangent that decides the margin, and the contact that it touches.
struct SupportTangent {
    double margin = 0;
    glm::dvec2 outward{0};  // unit
    const Contact* contact = nullptr;
};
SupportTangent supportTangent(const Contacts& contacts, const glm::dvec3& massCentre);
// That one, and those others beyond which the boundary is farther, whose margin is no more than `beyond` greater: in the middle of a narrow support
// the nearest alone says nothing of what would help.
void findSupportTangents(const Contacts& contacts, const glm::dvec3& massCentre, double beyond,
                         std::vector<SupportTangent>& tangents);

// Area(SP_n), square metres.
double supportArea(const Contacts& contacts);

}  // namespace fantascope::theatre
