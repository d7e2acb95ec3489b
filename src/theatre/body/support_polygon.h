#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace fantascope::theatre {

// A disc in which a body touches the ground, seen from above: (x, z) in metres. A point of a skin
// has no radius.
struct Contact {
    glm::dvec2 place{0};
    double radius = 0;
    std::uint32_t source = 0;  // which sphere or vertex it is of
    double share = 1;          // of its place and radius that it has: findBearings()
    glm::dvec3 point{0};       // where it is on the body
    glm::dvec3 along{0};       // of an edge of the skin that is cut there: where the point goes when the edge rises
};

// A tangent of a support polygon at which its boundary is nearer to the mass centre than at all
// tangents beside it.
struct SupportTangent {
    double margin = 0;      // the mass centre's signed distance from it, metres; positive inside
    glm::dvec2 outward{0};  // unit
    // What it touches: the two contacts of an edge, or one of an arc, given twice. The derivative
    // of `margin` is share * outward by a contact's place, share by its radius, and -outward by the
    // mass centre.
    struct Touch {
        std::uint32_t contact = 0;  // of those that the polygon was built of
        double share = 0;           // the two add up to 1
    };
    std::array<Touch, 2> touches{};
};

// The support polygon SP of Won & Lee 2016, equation 6: the convex hull of discs. Its boundary
// consists of arcs of discs and of edges between them, on their common outer tangents. It keeps its
// memory from build to build. Thread: thread-bound.
class SupportPolygon {
public:
    // Of one contact or more; they may coincide, lie in each other or on a line.
    void build(std::span<const Contact> contacts);
    // The same, and takes away those contacts that have no part of the boundary.
    void buildAndPrune(std::vector<Contact>& contacts);

    // Margin(SP, COM): the signed distance from the mass centre, seen from above, to the boundary,
    // metres; positive inside.
    double margin(const glm::dvec3& massCentre) const;
    // All tangents whose margin is within `tolerance` of the smallest, that one among them.
    void findTangents(const glm::dvec3& massCentre, double tolerance, std::vector<SupportTangent>& tangents) const;
    // Area(SP), square metres.
    double area() const;

private:
    // An arc of a contact's disc, and the edge from it to the next corner's. A disc may have
    // several.
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

    std::vector<Corner> corners_;  // anticlockwise; one alone has no edge
    std::vector<glm::dvec2> places_;
    std::vector<std::uint32_t> order_;
};

}  // namespace fantascope::theatre
