#pragma once

#include "theatre/body/body_mesh.h"
#include "theatre/body/support_polygon.h"

#include <cstdint>
#include <span>
#include <vector>

namespace fantascope::theatre {

// How a body touches the ground: Won & Lee 2016, equation 6. The ground is seen from above, (x, z)
// in metres.

// A point no higher than this above the ground touches it, since flesh gives way. Metres.
constexpr double kTouch = 0.01;

// The discs where a body touches the floor. A sphere's disc is its cross-section at the height
// kTouch, at most its great circle. If nothing touches, `touches` is false, and the only disc is
// the place of the lowest point, with radius 0.
struct Contacts {
    std::vector<Contact> discs;
    bool touches = false;
    double lowest = 0;  // the height of the lowest point, metres
    std::uint32_t lowestSource = 0;
    SupportPolygon support{};  // the convex hull of the discs
};
void findContacts(std::span<const PlacedSphere> spheres, Contacts& contacts);
// The same for a skin: its vertices no higher than kTouch, and the points where its edges cross
// that height, as discs of radius 0. Only the corners of the support polygon are kept.
void findContacts(std::span<const glm::vec3> vertices, std::span<const MeshEdge> edges, Contacts& contacts);

// A continuous version for a search, with the floor raised or lowered to the lowest point. Up to
// kTouch / 2 above that point the body bears fully. Over the next `bearing` metres the share it
// bears falls to 0; as it falls, the disc shrinks and moves towards the lowest point.
void findBearings(std::span<const PlacedSphere> spheres, double bearing, Contacts& contacts);
void findBearings(std::span<const glm::vec3> vertices, std::span<const MeshEdge> edges, double bearing, Contacts& contacts);

}  // namespace fantascope::theatre
