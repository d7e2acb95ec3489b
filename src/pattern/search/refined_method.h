#pragma once

#include "pattern/search/pattern_search.h"
#include "pattern/search/search_space.h"

#include <vector>

namespace fantascope::pattern {

// One move at a time: an instance is shifted, turned, tilted, scaled, put elsewhere, created or
// deleted, the change of the goal is computed exactly from its own pixels (RunningScore), and the
// move is kept when the goal falls, or, with a probability that shrinks with the temperature, when
// it rises (Metropolis et al. 1953, Kirkpatrick et al. 1983). The goal is detail, tone and overlap,
// with the weights of Options::Refined. An iteration is a thousand moves.
//
// Begins with the given instances, if there are any, and then cold, so that what is good stays;
// with Options::region, those whose centre lies outside of it are left as they are. Fills
// `instances`, colours and groups of new ones aside; new ones come last.
PatternSearch::Summary searchRefined(const SearchSpace& space, std::vector<ShapeInstance>& instances,
                                     const PatternSearch::AskStop& askStop, const PatternSearch::Plan& plan);

}  // namespace fantascope::pattern
