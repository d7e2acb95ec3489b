#pragma once

#include <algorithm>
#include <vector>

namespace fantascope {

// The middle one of some values, the upper one of two. `values` is not empty.
template <class Value>
Value medianOf(std::vector<Value> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace fantascope
