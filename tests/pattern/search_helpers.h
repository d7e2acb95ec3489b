#pragma once
// What the tests of every search method need.

#include "pattern/search/pattern_search.h"
#include "pattern/shape/elemental_shape.h"

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <vector>

namespace fantascope::pattern {

using StopReason = PatternSearch::StopReason;

inline ShapePattern withShapes(std::initializer_list<const char*> names, std::uint64_t seed = 1) {
    ShapePattern pattern;
    pattern.seed = seed;
    for (const char* name : names) pattern.shapes.push_back(loadShape(name).value());
    return pattern;
}

inline std::optional<StopReason> never(const PatternSearch::Progress&) { return std::nullopt; }

inline bool same(const std::vector<ShapeInstance>& a, const std::vector<ShapeInstance>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const ShapeInstance& x, const ShapeInstance& y) {
        return x.id == y.id && x.shape == y.shape && x.group == y.group && x.centre == y.centre && x.size == y.size &&
               x.rotation == y.rotation && x.colour == y.colour;
    });
}

}  // namespace fantascope::pattern
