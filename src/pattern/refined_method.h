#pragma once

#include "pattern/pattern_search.h"
#include "pattern/search_space.h"

#include <vector>

namespace fantascope::pattern {

// One move at a time: an instance is shifted, turned, tilted, scaled, put elsewhere, created or deleted, the change of the goal is
// computed exactly from its own pixels (RunningScore), and the move is kept when the goal falls, or, with a probability that shrinks
// with the temperature, when it rises (Metropolis et al. 1953, Kirkpatrick et al. 1983). The goal is z, the tone and the overlap, with the
// weights of Options::Refined. An iteration is a thousand moves. Fills `instances`, colours and groups aside.
PatternSearch::Summary searchRefined(const SearchSpace& space, std::vector<ShapeInstance>& instances,
                                     const PatternSearch::AskStop& askStop, const PatternSearch::Plan& plan);

}  // namespace fantascope::pattern
