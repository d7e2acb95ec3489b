#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace fantascope::theatre {

// A disc in which a body touches the ground, seen from above: (x, z) in metres. For a point of a
// skin the radius is 0.
struct Contact {
    glm::dvec2 place{0};
    double radius = 0;
    std::uint32_t source = 0;  // index of its sphere or vertex
    double share = 1;          // how much it bears, 0 .. 1: findBearings()
    glm::dvec3 point{0};       // where it is on the body
    glm::dvec3 along{0};       // of a skin's edge that is cut here: the direction in which the point moves when the edge rises
};

// A tangent of a support polygon at which the margin has a local minimum.
struct SupportTangent {
    double margin = 0;      // the mass centre's signed distance from it, metres; positive inside
    glm::dvec2 outward{0};  // unit
    // The contacts that it touches: the two of an edge, or the one of an arc, given twice. The
    // derivative of `margin` is share * outward by a contact's place, share by its radius, and
    // -outward by the mass centre.
    struct Touch {
        std::uint32_t contact = 0;  // index among the contacts that the polygon was built of
        double share = 0;           // the two add up to 1
    };
    std::array<Touch, 2> touches{};
};

// The support polygon SP of Won & Lee 2016, equation 6: the convex hull of discs. Its boundary
// consists of arcs of discs and of edges between them, on their common outer tangents. Memory is
// reused from build to build. Thread: thread-bound.
class SupportPolygon {
public:
    // Builds the hull of one or more contacts. They may coincide, contain each other, or lie on a
    // line.
    void build(std::span<const Contact> contacts);
    // The same, and removes the contacts that are not on the boundary.
    void buildAndPrune(std::vector<Contact>& contacts);

    // Margin(SP, COM): the signed distance from the mass centre, seen from above, to the boundary,
    // metres; positive inside.
    double margin(const glm::dvec3& massCentre) const;
    // All tangents whose margin is within `tolerance` of the smallest, that one among them.
    void findTangents(const glm::dvec3& massCentre, double tolerance, std::vector<SupportTangent>& tangents) const;
    // Area(SP), square metres.
    double area() const;

private:
    // An arc of a contact's disc, and the edge from it to the next corner. A disc may have several
    // arcs.
    struct Corner {
        std::uint32_t contact = 0;
        glm::dvec2 place{0};
        double radius = 0;
        glm::dvec2 outward{0};  // the edge's normal, unit: the arc ends there
        bool isWide = false;    // the arc is longer than half a turn
    };
    void buildOfPoints(std::span<const Contact> contacts);
    void buildOfDiscs(std::span<const Contact> contacts);
    void addCorner(std::span<const Contact> contacts, std::uint32_t contact, const glm::dvec2& outward, bool isWide);
    bool hasOnArc(std::size_t corner, const glm::dvec2& direction) const;
    const Corner& before(std::size_t corner) const { return corners_[corner == 0 ? corners_.size() - 1 : corner - 1]; }
    const Corner& after(std::size_t corner) const { return corners_[corner + 1 == corners_.size() ? 0 : corner + 1]; }

    std::vector<Corner> corners_;  // anticlockwise; a single corner has no edge
    std::vector<glm::dvec2> places_;
    std::vector<std::uint32_t> order_;
};

}  // namespace fantascope::theatre
