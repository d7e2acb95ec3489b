#include "theatre/search/solution_choice.h"

#include "core/check.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>

namespace fantascope::theatre {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

double between(const PlacedActor& a, const PlacedActor& b) {
    FANTASCOPE_CHECK(a.joints.size() == b.joints.size() && !a.joints.empty(), "actors have the same joints");
    double sum = 0;
    for (std::size_t i = 0; i < a.joints.size(); ++i) sum += glm::distance(a.joints[i], b.joints[i]);
    return sum / static_cast<double>(a.joints.size());
}

// The minimum-cost assignment of one column to each row: the Hungarian method with potentials (Kuhn
// 1955; Jonker & Volgenant 1987). cost(row, column) is finite. Inside, rows and columns count from
// 1, and 0 means none.
template <class Cost>
double leastAssignment(std::size_t count, Cost cost) {
    std::vector<double> ofRow(count + 1, 0), ofColumn(count + 1, 0);
    std::vector<std::size_t> rowOf(count + 1, 0), before(count + 1, 0);
    for (std::size_t row = 1; row <= count; ++row) {
        // The shortest path from the new row over assigned columns to a free one.
        std::vector<double> least(count + 1, kInfinite);
        std::vector<char> seen(count + 1, 0);
        std::size_t column = 0;
        rowOf[0] = row;
        do {
            seen[column] = 1;
            const std::size_t here = rowOf[column];
            std::size_t next = 0;
            double step = kInfinite;
            for (std::size_t j = 1; j <= count; ++j) {
                if (seen[j]) continue;
                const double reduced = cost(here - 1, j - 1) - ofRow[here] - ofColumn[j];
                if (reduced < least[j]) least[j] = reduced, before[j] = column;
                if (least[j] < step) step = least[j], next = j;
            }
            for (std::size_t j = 0; j <= count; ++j) {
                if (seen[j])
                    ofRow[rowOf[j]] += step, ofColumn[j] -= step;
                else
                    least[j] -= step;
            }
            column = next;
        } while (rowOf[column] != 0);
        // Along the path, every column is reassigned to the previous row.
        while (column != 0) rowOf[column] = rowOf[before[column]], column = before[column];
    }
    double sum = 0;
    for (std::size_t j = 1; j <= count; ++j) sum += cost(rowOf[j] - 1, j - 1);
    return sum;
}

}  // namespace

double difference(std::span<const PlacedActor> a, std::span<const PlacedActor> b) {
    FANTASCOPE_CHECK(a.size() == b.size(), "solutions of one problem have the same actors");
    if (a.empty()) return 0;
    // Each stature is assigned separately.
    std::vector<double> statures;
    for (const PlacedActor& actor : a) statures.push_back(actor.stature);
    std::sort(statures.begin(), statures.end());
    statures.erase(std::unique(statures.begin(), statures.end()), statures.end());
    double sum = 0;
    std::size_t assigned = 0;
    for (const double stature : statures) {
        const auto having = [&](std::span<const PlacedActor> all) {
            std::vector<const PlacedActor*> group;
            for (const PlacedActor& actor : all)
                if (actor.stature == stature) group.push_back(&actor);
            return group;
        };
        const auto ofA = having(a), ofB = having(b);
        FANTASCOPE_CHECK(ofA.size() == ofB.size(), "solutions of one problem have actors of the same statures");
        sum += leastAssignment(ofA.size(), [&](std::size_t i, std::size_t j) { return between(*ofA[i], *ofB[j]); });
        assigned += ofA.size();
    }
    return sum / static_cast<double>(assigned);
}

std::vector<std::size_t> mostDifferent(std::span<const std::vector<PlacedActor>> solutions, std::size_t count) {
    std::vector<std::size_t> chosen;
    std::vector<double> nearest(solutions.size(), kInfinite);  // distance to the nearest chosen solution; -1: chosen itself
    while (chosen.size() < std::min(count, solutions.size())) {
        const auto next = static_cast<std::size_t>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
        chosen.push_back(next);
        for (std::size_t i = 0; i < solutions.size(); ++i)
            nearest[i] = std::min(nearest[i], difference(solutions[i], solutions[next]));
        nearest[next] = -1;
    }
    return chosen;
}

}  // namespace fantascope::theatre
