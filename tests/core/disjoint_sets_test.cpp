#include "core/disjoint_sets.h"

#include "core/random.h"

#include <gmock/gmock.h>

#include <set>
#include <vector>

namespace fantascope {
namespace {

// Compared with sets that are joined by relabelling every number. Example failure: the root depends
// on the order of joining.
TEST(DisjointSets, are_joined_under_their_smallest_number) {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        Rng rng(seed);
        constexpr std::size_t kNumbers = 40;
        DisjointSets sets(kNumbers / 2);
        while (sets.count() < kNumbers) sets.add();
        std::vector<std::size_t> smallest(kNumbers);
        for (std::size_t i = 0; i < kNumbers; ++i) smallest[i] = i;
        for (int joins = 0; joins < 45; ++joins) {
            const std::size_t a = rng.below(kNumbers), b = rng.below(kNumbers);
            const std::size_t stays = std::min(smallest[a], smallest[b]), goes = std::max(smallest[a], smallest[b]);
            ASSERT_EQ(sets.join(a, b), std::pair(stays, goes));
            for (std::size_t& number : smallest)
                if (number == goes) number = stays;
            for (std::size_t i = 0; i < kNumbers; ++i) ASSERT_EQ(sets.root(i), smallest[i]) << "seed " << seed;
            ASSERT_EQ(sets.count(), std::set(smallest.begin(), smallest.end()).size());
        }
    }
}

}  // namespace
}  // namespace fantascope
