#pragma once

#include "media/mesh.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace fantascope::theatre {

// A solid on a grid of nodes, the union of whatever is added to it, however that overlaps or runs
// into itself. Kept are which nodes are inside, and near the surface how far it is. Any unit of
// length. Thread: thread-bound.
class VoxelSolid {
public:
    // The signed distance to something, negative inside, or less; no steeper than 1.
    using Field = std::function<double(const glm::dvec3&)>;
    struct Box {
        glm::dvec3 least, most;
    };

    // The grid begins at `within.least`; whatever is added lies three cells or more within. `band`:
    // up to what distance from the surface distances are known; three cells or more.
    VoxelSolid(const Box& within, double cell, double band);
    static double nodesOf(const Box& within, double cell);
    double cell() const { return cell_; }

    // What a closed mesh winds around; of one that is open, what an odd number of its triangles
    // lies before by two of the three axes, so that a small hole does no harm. Where that is so
    // thin that no node a cell behind a triangle is inside, the triangle itself becomes solid, this
    // thick.
    void add(const TriangleMesh& mesh, double sheet);
    // `around`: a box that holds it.
    void add(const Field& field, const Box& around);
    void addRod(const glm::dvec3& from, const glm::dvec3& to, double radius);

    // Takes away what lies below a height.
    void cutBelow(double height);
    // What nothing from outside reaches becomes solid.
    void fillCavities();
    // A piece that hangs together, apart from the others: some nodes next to its surface, not more
    // than kSome.
    struct Piece {
        std::uint64_t nodes = 0;  // inside
        std::vector<glm::dvec3> some;
        std::uint32_t number = 0;
    };
    static constexpr std::size_t kSome = 20'000;
    // The largest first. Numbers stay true until something is added.
    std::vector<Piece> pieces();
    void remove(const Piece& piece);

    // Where a ball that touches the surface all around would be smaller than a wall is to be:
    // middles of limbs and sheets, not the corners of what is thick. `thickness`: from surface to
    // surface, through the middle.
    struct Thin {
        glm::dvec3 middle{0};
        double thickness = 0;
    };
    std::vector<Thin> thinnerThan(double wall) const;

    // Closed, no triangle without an area, and none that runs through another.
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
    // The nodes in a box, cut at the grid's edges.
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
    // How far it is from a place on the surface straight on to the other side, `most` at most; the
    // first `from` of it are known to be inside.
    double through(const glm::dvec3& surface, const glm::dvec3& way, double from, double most) const;
    // All but those of the grid's outermost layer.
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
    // Distances, negative inside, where one is known: in blocks of nodes.
    std::vector<std::int32_t> block_;
    std::vector<std::array<float, kBlock * kBlock * kBlock>> values_;
};

}  // namespace fantascope::theatre
