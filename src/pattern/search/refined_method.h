#pragma once

#include "pattern/search/pattern_search.h"
#include "pattern/search/search_space.h"

#include <vector>

namespace fantascope::pattern {

// Simulated annealing, one move at a time: a move shifts, turns, tilts, scales, relocates, creates
// or deletes one instance. The change of the goal is computed exactly from that instance's pixels
// (RunningScore). The move is accepted if the goal falls, or, with a probability that shrinks with
// the temperature, if it rises (Metropolis et al. 1953, Kirkpatrick et al. 1983). The goal is the
// sum of detail, tone and overlap with the weights of Options::Refined. An iteration is 1000 moves.
//
// Given instances are the start, and the search then begins cold, to preserve what is good. With
// Options::changeCost, a change is accepted only if the goal falls by that much more. With
// Options::region, instances whose centre lies outside stay as they are. Fills `instances`, except
// the colours and groups of new ones, which come last.
PatternSearch::Summary searchRefined(const SearchSpace& space, std::vector<ShapeInstance>& instances,
                                     const PatternSearch::AskStop& askStop, const PatternSearch::Plan& plan);

}  // namespace fantascope::pattern
