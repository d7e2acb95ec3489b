#pragma once

#include "media/mesh.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace fantascope::theatre {

// A solid on a grid of nodes: the union of everything added, which may overlap or intersect itself.
// It stores which nodes are inside, and near the surface their distance from it. Any unit of
// length. Thread: thread-bound.
class VoxelSolid {
public:
    // A signed distance, negative inside, or a lower bound of it; its slope is at most 1.
    using Field = std::function<double(const glm::dvec3&)>;
    struct Box {
        glm::dvec3 least, most;
    };

    // The grid begins at `within.least`. Everything added must lie three cells or more within the
    // box. `band`: the distance from the surface up to which distances are stored; three cells or
    // more.
    VoxelSolid(const Box& within, double cell, double band);
    static double nodesOf(const Box& within, double cell);
    double cell() const { return cell_; }

    // Adds the interior of a mesh. For a closed mesh it is where the winding number is not 0. For
    // an open one a node is inside if, along at least two of the three axes, an odd number of
    // triangles lies before it, so that a small hole does no harm. If no node a cell behind a
    // triangle is inside, the triangle itself becomes a solid sheet of thickness `sheet`.
    void add(const TriangleMesh& mesh, double sheet);
    // `around`: a box that contains the field's interior.
    void add(const Field& field, const Box& around);
    void addRod(const glm::dvec3& from, const glm::dvec3& to, double radius);

    // Removes everything below a height.
    void cutBelow(double height);
    // Cavities with no connection to the outside become solid.
    void fillCavities();
    // A connected component, with a sample of nodes next to its surface, about kSome at most.
    struct Piece {
        std::uint64_t nodes = 0;  // number of its nodes
        std::vector<glm::dvec3> some;
        std::uint32_t number = 0;
    };
    static constexpr std::size_t kSome = 20'000;
    // The pieces, the largest first. Their numbers are valid until something is added.
    std::vector<Piece> pieces();
    void remove(const Piece& piece);

    // Where an inscribed ball would have a diameter less than `wall`: the middles of limbs and
    // sheets, not the corners of thick parts. `thickness`: from surface to surface, through the
    // middle.
    struct Thin {
        glm::dvec3 middle{0};
        double thickness = 0;
    };
    std::vector<Thin> thinnerThan(double wall) const;

    // The surface: closed, without degenerate triangles, and without self-intersections.
    TriangleMesh surface() const;

private:
    class Depths;  // voxel_walls.cpp
    using Node = std::array<int, 3>;
    static constexpr int kBlock = 8;
    // A run of nodes along x that are all inside, or all outside.
    struct Run {
        int from, to;
        std::uint32_t component;
    };
    struct Runs {
        std::vector<Run> runs;
        std::vector<std::size_t> rows;  // the first of each row; rows along y fastest
    };

    std::size_t index(const Node& node) const {
        return (static_cast<std::size_t>(node[2]) * static_cast<std::size_t>(count_[1]) + static_cast<std::size_t>(node[1])) *
                   static_cast<std::size_t>(count_[0]) +
               static_cast<std::size_t>(node[0]);
    }
    glm::dvec3 place(const Node& node) const { return least_ + cell_ * glm::dvec3(node[0], node[1], node[2]); }
    // The first and the last node in a box, clamped to the grid.
    std::array<Node, 2> nodesIn(const Box& box) const;
    std::size_t blockOf(const Node& node) const;
    static std::size_t inBlock(const Node& node) {
        return static_cast<std::size_t>((node[2] % kBlock * kBlock + node[1] % kBlock) * kBlock + node[0] % kBlock);
    }
    float* find(const Node& node);
    const float* find(const Node& node) const;
    float& make(const Node& node);
    void unite(const Node& node, double distance);
    double value(const Node& node) const;
    double at(const glm::dvec3& point) const;
    void vote(const TriangleMesh& mesh, int axis, bool winds, const std::array<Node, 2>& box,
              std::vector<std::uint8_t>& votes) const;
    Runs runsOf(bool inside) const;
    // The distance from a place on the surface, along `way`, to the opposite surface, at most
    // `most`. The first `from` of it are known to be inside.
    double through(const glm::dvec3& surface, const glm::dvec3& way, double from, double most) const;
    // Visits all inner nodes except the grid's outermost layer.
    template <class Visit>
    void forNodesInside(Visit visit) const {
        for (int z = 1; z + 1 < count_[2]; ++z)
            for (int y = 1; y + 1 < count_[1]; ++y)
                for (int x = 1; x + 1 < count_[0]; ++x)
                    if (const Node node{x, y, z}; inside_[index(node)] != 0) visit(node);
    }

    glm::dvec3 least_{0};
    double cell_ = 1, band_ = 3;
    Node count_{}, blockCount_{};
    std::vector<std::uint8_t> inside_;
    // Distances, where known, in blocks of nodes; negative inside.
    std::vector<std::int32_t> block_;
    std::vector<std::array<float, kBlock * kBlock * kBlock>> values_;
};

}  // namespace fantascope::theatre
