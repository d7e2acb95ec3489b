#include "theatre/print/voxel_solid.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <cstdint>
#include <optional>

namespace fantascope::theatre {

using glm::dvec3;

// The depths of inner nodes, up to `deepest`. A depth is the distance to the nearest place where
// the surface crosses an edge of the grid; places are propagated inwards from node to node.
class VoxelSolid::Depths {
public:
    struct Depth {
        dvec3 surface{0};  // the nearest place on the surface
        double depth = 0;
    };
    Depths(const VoxelSolid& solid, double deepest) : solid_(solid), deepest_(deepest), blocks_(solid.block_.size(), -1) {
        std::vector<Node> front;
        solid.forNodesInside([&](const Node& node) {
            if (const auto nearest = besideSurface(node)) {
                add(node, *nearest);
                front.push_back(node);
            }
        });
        carryInwards(std::move(front));
    }

    const Depth* find(const Node& node) const {
        const std::int32_t block = blocks_[solid_.blockOf(node)];
        if (block < 0) return nullptr;
        const std::int32_t number = numbers_[static_cast<std::size_t>(block)][inBlock(node)];
        return number < 0 ? nullptr : &depths_[static_cast<std::size_t>(number)];
    }
    // Whether a node is a local maximum of depth, up to the slope of a limb's taper. In a thick
    // part's edge the depth grows faster towards the middle, unless the edge is sharper than about
    // 40 degrees.
    bool isMiddle(const Node& node, const Depth& found) const {
        constexpr double kTaper = 0.35;
        bool isMiddle = true;
        forNeighbours(node, [&](const Node& other) {
            const Depth* const its = find(other);
            const double depth = its == nullptr ? deepest_ : its->depth;
            if (depth - found.depth > kTaper * glm::distance(solid_.place(node), solid_.place(other))) isMiddle = false;
        });
        return isMiddle;
    }

private:
    void add(const Node& node, const Depth& depth) {
        std::int32_t& block = blocks_[solid_.blockOf(node)];
        if (block < 0) {
            block = static_cast<std::int32_t>(numbers_.size());
            numbers_.emplace_back().fill(-1);
        }
        numbers_[static_cast<std::size_t>(block)][inBlock(node)] = static_cast<std::int32_t>(depths_.size());
        depths_.push_back(depth);
    }
    // The depth of an inner node that has an outer neighbour along an axis.
    std::optional<Depth> besideSurface(const Node& node) const {
        std::optional<Depth> nearest;
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (const int step : {-1, 1}) {
                Node other = node;
                other[axis] += step;
                if (solid_.inside_[solid_.index(other)] != 0) continue;
                const double in = -solid_.value(node), out = solid_.value(other);
                const dvec3 surface = glm::mix(solid_.place(node), solid_.place(other), in / (in + out));
                const double depth = glm::distance(surface, solid_.place(node));
                if (!nearest || depth < nearest->depth) nearest = Depth{surface, depth};
            }
        return nearest;
    }
    template <class Visit>
    void forNeighbours(const Node& node, Visit visit) const {
        for (int dz = -1; dz <= 1; ++dz)
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx) {
                    const Node other{node[0] + dx, node[1] + dy, node[2] + dz};
                    if (other != node && solid_.inside_[solid_.index(other)] != 0) visit(other);
                }
    }
    void carryInwards(std::vector<Node> front) {
        std::vector<Node> next;
        for (; !front.empty(); front.swap(next)) {
            next.clear();
            for (const Node& node : front) {
                const Depth known = *find(node);
                forNeighbours(node, [&](const Node& other) {
                    const double depth = glm::distance(known.surface, solid_.place(other));
                    if (depth > deepest_) return;
                    if (Depth* const there = const_cast<Depth*>(find(other))) {
                        if (depth >= there->depth - 1e-9 * solid_.cell_) return;
                        *there = {known.surface, depth};
                    } else {
                        add(other, {known.surface, depth});
                    }
                    next.push_back(other);
                });
            }
        }
    }

    const VoxelSolid& solid_;
    const double deepest_;
    std::vector<Depth> depths_;
    // The index of each node in depths_, in blocks; -1: none.
    std::vector<std::int32_t> blocks_;
    std::vector<std::array<std::int32_t, kBlock * kBlock * kBlock>> numbers_;
};

double VoxelSolid::through(const dvec3& surface, const dvec3& way, double from, double most) const {
    double through = from, last = at(surface + through * way);
    for (const double step = 0.25 * cell_; through < most; through += step) {
        const double here = at(surface + (through + step) * way);
        if (here >= 0) {
            through += last < 0 ? step * last / (last - here) : 0;
            break;
        }
        last = here;
    }
    return through;
}

std::vector<VoxelSolid::Thin> VoxelSolid::thinnerThan(double wall) const {
    const Depths depths(*this, 0.5 * wall + 2 * cell_);
    std::vector<Thin> thin;
    forNodesInside([&](const Node& node) {
        const Depths::Depth* const found = depths.find(node);
        if (found == nullptr || found->depth > 0.5 * wall || !depths.isMiddle(node, *found)) return;
        const dvec3 along = place(node) - found->surface;
        const dvec3 way = glm::length(along) > 0 ? glm::normalize(along) : dvec3(0, 1, 0);
        const double thickness = through(found->surface, way, found->depth, wall);
        if (thickness < wall) thin.push_back({found->surface + 0.5 * thickness * way, thickness});
    });
    return thin;
}

}  // namespace fantascope::theatre
