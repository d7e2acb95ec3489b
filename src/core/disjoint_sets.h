#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace fantascope {

// Disjoint sets of the numbers 0, 1, 2, ... that are joined one by one. The root of a set is its
// smallest number, in whatever order sets are joined.
// Source: union-find with path halving (Tarjan & van Leeuwen 1984). Thread: bound to one thread at
// a time.
class DisjointSets {
public:
    // The numbers 0 to `count` - 1, each in a set of its own.
    explicit DisjointSets(std::size_t count = 0) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0u); }

    // Adds the next number, in a set of its own.
    std::size_t add() {
        parents_.push_back(static_cast<std::uint32_t>(parents_.size()));
        return parents_.size() - 1;
    }
    std::size_t root(std::size_t number) {
        auto i = static_cast<std::uint32_t>(number);
        while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
        return i;
    }
    // Joins two sets. Returns the root that remains and the root that is none any more; they are
    // equal if the sets were joined before.
    std::pair<std::size_t, std::size_t> join(std::size_t one, std::size_t other) {
        const auto [stays, goes] = std::minmax({root(one), root(other)});
        parents_[goes] = static_cast<std::uint32_t>(stays);
        return {stays, goes};
    }
    // The number of sets.
    std::size_t count() const {
        std::size_t roots = 0;
        for (std::size_t i = 0; i < parents_.size(); ++i) roots += parents_[i] == i;
        return roots;
    }

private:
    std::vector<std::uint32_t> parents_;
};

}  // namespace fantascope
