#include "theatre/body/support_polygon.h"

#include "theatre/mask/convex_outline.h"

#include "core/check.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace fantascope::theatre {
namespace {

using glm::dvec2;

double cross(const dvec2& a, const dvec2& b) { return a.x * b.y - a.y * b.x; }
dvec2 turnedLeft(const dvec2& v) { return {-v.y, v.x}; }
// The product of complex numbers: turns add up.
dvec2 product(const dvec2& a, const dvec2& b) { return {a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x}; }

// The normal of the common tangent that touches one disc first and then, anticlockwise, the other.
dvec2 normalBetween(const Contact& from, const Contact& to) {
    const dvec2 apart = to.place - from.place;
    const double square = glm::dot(apart, apart), less = from.radius - to.radius;
    return glm::normalize(less * apart - std::sqrt(std::max(0.0, square - less * less)) * turnedLeft(apart));
}

// The angle by which a tangent of one disc must turn until it touches another.
struct Turn {
    dvec2 half{0};      // the direction of half the turn, 0 .. pi, of any length
    double onward = 0;  // distance from the first disc's touching point to the second's

    bool isBefore(const Turn& other) const {
        const double between = cross(half, other.half);
        return between > 0 || (between == 0 && onward > other.onward);
    }
};

// The turn is anticlockwise from the tangent of `from` with this normal. False if `to` lies in
// `from`. `to` must not reach beyond that tangent.
//
// With the other's place relative to this one's, (a, b) along and across the normal, and r, the
// difference of the radii, the other is touched after a turn t where a cos t + b sin t = r: a
// quadratic equation for tan(t / 2). The solution taken is the one after which the other disc
// reaches farther. If the tangent touches the other disc already, or the other disc contains this
// one, the turn is 0.
bool findTurn(const Contact& from, const Contact& to, const dvec2& normal, Turn& turn) {
    const dvec2 apart = to.place - from.place;
    const double r = from.radius - to.radius, square = glm::dot(apart, apart) - r * r;
    if (square <= 0) {
        turn = {{1, 0}, std::numeric_limits<double>::infinity()};
        return r < 0;
    }
    const double a = glm::dot(apart, normal), b = glm::dot(apart, turnedLeft(normal)), s = std::sqrt(square);
    turn.half = b >= 0 ? dvec2(b + s, std::max(0.0, r - a)) : dvec2(-(a + r), s - b);
    turn.onward = s;
    return true;
}

}  // namespace

void SupportPolygon::build(std::span<const Contact> contacts) {
    FANTASCOPE_CHECK(!contacts.empty(), "a body stands on something");
    corners_.clear();
    if (std::all_of(contacts.begin(), contacts.end(), [](const Contact& contact) { return contact.radius == 0; }))
        buildOfPoints(contacts);
    else
        buildOfDiscs(contacts);
}

void SupportPolygon::addCorner(std::span<const Contact> contacts, std::uint32_t contact, const dvec2& outward, bool isWide) {
    corners_.push_back({contact, contacts[contact].place, contacts[contact].radius, outward, isWide});
}

// A skin has many contacts, all points: Andrew 1979.
void SupportPolygon::buildOfPoints(std::span<const Contact> contacts) {
    places_.clear();
    for (const Contact& contact : contacts) places_.push_back(contact.place);
    findHull(places_, order_);
    for (std::size_t i = 0; i < order_.size(); ++i) {
        const Contact &contact = contacts[order_[i]], &next = contacts[order_[i + 1 == order_.size() ? 0 : i + 1]];
        addCorner(contacts, order_[i], order_.size() == 1 ? dvec2(0) : normalBetween(contact, next), false);
    }
}

// Gift wrapping (Jarvis 1973): a tangent rolls around the discs, from each to the one that it
// touches next.
void SupportPolygon::buildOfDiscs(std::span<const Contact> contacts) {
    // The start direction is arbitrary, but one in which edges are rare.
    const dvec2 start(std::cos(1.0), std::sin(1.0));
    const auto reach = [&](const Contact& contact) { return glm::dot(contact.place, start) + contact.radius; };
    std::uint32_t first = 0;
    for (std::uint32_t i = 1; i < contacts.size(); ++i)
        if (const double more = reach(contacts[i]) - reach(contacts[first]);
            more > 0 || (more == 0 && contacts[i].radius > contacts[first].radius))
            first = i;

    std::uint32_t current = first;
    dvec2 normal = start, half(1, 0), firstHalf(1, 0);  // half: half the sum of all turns so far
    while (corners_.size() < 2 * contacts.size()) {     // a hull of n discs has fewer corners
        Turn least, turn;
        std::uint32_t next = current;
        for (std::uint32_t i = 0; i < contacts.size(); ++i)
            if (i != current && findTurn(contacts[current], contacts[i], normal, turn) &&
                (next == current || turn.isBefore(least)))
                least = turn, next = i;
        if (next == current) {  // it contains all others
            corners_.clear();
            return addCorner(contacts, current, dvec2(0), true);
        }
        least.half = glm::normalize(least.half);
        const dvec2 sum = product(half, least.half);
        const bool isAround = sum.y < 0 || (sum.y == 0 && sum.x < 0);
        const bool isFirstEdge = corners_.size() > 1 && current == corners_[0].contact && next == corners_[1].contact;
        if (isAround || isFirstEdge) break;
        if (corners_.empty()) firstHalf = least.half;
        if (!std::isinf(least.onward)) normal = normalBetween(contacts[current], contacts[next]);
        addCorner(contacts, current, normal, least.half.x < 0);
        half = sum, current = next;
    }
    // The last arc ends at the start direction: it merges with the first arc, or an edge lies
    // exactly there.
    const dvec2 rest(-half.x, half.y);
    if (current == first)
        corners_[0].isWide = product(rest, firstHalf).x < 0;
    else
        addCorner(contacts, current, normalBetween(contacts[current], contacts[first]), rest.x < 0);
}

void SupportPolygon::buildAndPrune(std::vector<Contact>& contacts) {
    build(contacts);
    order_.clear();
    for (const Corner& corner : corners_) order_.push_back(corner.contact);
    std::sort(order_.begin(), order_.end());
    order_.erase(std::unique(order_.begin(), order_.end()), order_.end());
    for (std::size_t i = 0; i < order_.size(); ++i) contacts[i] = contacts[order_[i]];
    contacts.resize(order_.size());
    for (Corner& corner : corners_)
        corner.contact =
            static_cast<std::uint32_t>(std::lower_bound(order_.begin(), order_.end(), corner.contact) - order_.begin());
}

bool SupportPolygon::hasOnArc(std::size_t corner, const dvec2& direction) const {
    if (corners_.size() == 1) return true;
    const dvec2 from = before(corner).outward, to = corners_[corner].outward;
    if (corners_[corner].isWide) return !(cross(to, direction) > 0 && cross(direction, from) > 0);
    return cross(from, direction) >= 0 && cross(direction, to) >= 0 &&
           (glm::dot(from, direction) >= 0 || glm::dot(to, direction) >= 0);
}

// The smallest distance over all tangents. It belongs to an edge, or to the tangent of an arc whose
// normal points along the line from the disc's centre to the mass centre.
double SupportPolygon::margin(const glm::dvec3& massCentre) const {
    const dvec2 centre(massCentre.x, massCentre.z);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < corners_.size(); ++i) {
        const Corner& corner = corners_[i];
        const dvec2 away = centre - corner.place;
        if (corners_.size() > 1) least = std::min(least, corner.radius - glm::dot(away, corner.outward));
        if (hasOnArc(i, away)) least = std::min(least, corner.radius - glm::length(away));
    }
    return least;
}

void SupportPolygon::findTangents(const glm::dvec3& massCentre, double tolerance, std::vector<SupportTangent>& tangents) const {
    const dvec2 centre(massCentre.x, massCentre.z);
    const double most = margin(massCentre) + tolerance;
    tangents.clear();
    for (std::size_t i = 0; i < corners_.size(); ++i) {
        const Corner &corner = corners_[i], &next = after(i);
        const dvec2 away = centre - corner.place, along = turnedLeft(corner.outward);
        // An edge counts if the mass centre projects onto it; an arc counts if the mass centre lies
        // beyond the disc's centre.
        const double onward = glm::dot(away, along), left = glm::dot(next.place - centre, along);
        const double ofEdge = corner.radius - glm::dot(away, corner.outward);
        if (corners_.size() > 1 && onward >= 0 && left >= 0 && ofEdge <= most) {
            const double share = onward + left > 0 ? onward / (onward + left) : 0.5;
            tangents.push_back({ofEdge, corner.outward, {{{corner.contact, 1 - share}, {next.contact, share}}}});
        }
        const double distance = glm::length(away), ofArc = corner.radius - distance;
        if (ofArc <= most && hasOnArc(i, away))
            tangents.push_back(
                {ofArc, distance > 0 ? away / distance : dvec2(1, 0), {{{corner.contact, 1}, {corner.contact, 0}}}});
    }
}

double SupportPolygon::area() const {
    if (corners_.size() == 1) return std::numbers::pi * corners_[0].radius * corners_[0].radius;
    double twice = 0;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
        const Corner &corner = corners_[i], &next = after(i);
        const dvec2 from = before(i).outward, to = corner.outward, place = corner.place - corners_[0].place;
        twice += cross(place + corner.radius * to, next.place - corners_[0].place + next.radius * to);
        if (corner.radius == 0) continue;
        double turn = std::atan2(cross(from, to), glm::dot(from, to));
        if (turn < 0) turn = corner.isWide || turn < -1 ? turn + 2 * std::numbers::pi : 0;  // rounding: half a turn, or none
        twice += corner.radius * (corner.radius * turn + cross(place, to - from));
    }
    return 0.5 * twice;
}

}  // namespace fantascope::theatre
