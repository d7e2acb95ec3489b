#pragma once

#include "pattern/search/pattern_search.h"
#include "pattern/search/search_space.h"

#include <vector>

namespace fantascope::pattern {

// The stochastic optimisation of Ji et al. 2015, section 4.1, as written: in each iteration,
// candidates are made that differ from the reference solution in every instance, and the best
// replaces it if it is better. PatternSearch::Options::Paper sets what the paper leaves open: how
// small "small random amounts" are, and how large cells and shapes are. Fills `instances`, except
// colours and groups. The result does not depend on `threads`.
PatternSearch::Summary searchByPaper(const SearchSpace& space, std::vector<ShapeInstance>& instances, int threads,
                                     const PatternSearch::AskStop& askStop);

// p_cre of a lattice cell and p_del of an instance cell with difference index g; 0 if g does not
// pass the threshold.
double createProbability(double g, double lambdaCreate);
double deleteProbability(double g, double lambdaDelete);

}  // namespace fantascope::pattern
