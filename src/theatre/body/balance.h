#pragma once

#include "theatre/body/body_mesh.h"
#include "theatre/body/support_polygon.h"

#include <cstdint>
#include <span>
#include <vector>

namespace fantascope::theatre {

// How a body stands: Won & Lee 2016, equation 6. The ground is seen from above, (x, z) in metres.

// What is no higher than this above the ground touches it: flesh gives way.
constexpr double kTouch = 0.01;

// The discs where a body touches the floor: of a sphere of radius r whose lowest point is h above
// it, all that is below kTouch. A body that touches nothing has the place of its lowest point, with
// no radius, and `touches` false.
struct Contacts {
    std::vector<Contact> discs;
    bool touches = false;
    double lowest = 0;  // the height of the lowest point, metres
    std::uint32_t lowestSource = 0;
    SupportPolygon support{};  // of the discs
};
void findContacts(std::span<const PlacedSphere> spheres, Contacts& contacts);
// The same of a skin: what of it is no higher than kTouch, its edges cut there, as discs without a
// radius. Only the corners of the support polygon are kept.
void findContacts(std::span<const glm::vec3> vertices, std::span<const MeshEdge> edges, Contacts& contacts);

// The same for a search, without jumps, and as if the lowest point were on the floor: what is
// kTouch / 2 above it bears, and what is higher bears the less the higher it is, up to `bearing`
// metres more; the less it bears the nearer its disc is to the lowest point, and the smaller.
void findBearings(std::span<const PlacedSphere> spheres, double bearing, Contacts& contacts);
void findBearings(std::span<const glm::vec3> vertices, std::span<const MeshEdge> edges, double bearing, Contacts& contacts);

}  // namespace fantascope::theatre
