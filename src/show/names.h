#pragma once

#include "core/result.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope::show {

template <class Range>
std::vector<std::string> namesOf(const Range& things) {
    std::vector<std::string> names;
    names.reserve(things.size());
    for (const auto& thing : things) names.push_back(thing.name);
    return names;
}

// The list that is called so, as Input::list: "" is the main one, all others are `sides`; -1: none
// is called so.
int listNamed(std::string_view name, const std::vector<std::string>& sides);

// The index of `name` among `known`. Error: "no output is called 'lefd' (did you mean 'left'?)".
Result<std::size_t> findName(std::string_view name, const std::vector<std::string>& known, std::string_view what);

}  // namespace fantascope::show
