#pragma once

#include "pattern/search/pattern_search.h"
#include "pattern/search/search_space.h"

#include <vector>

namespace fantascope::pattern {

// The stochastic optimisation of Ji et al. 2015, section 4.1, as written: candidates that differ
// from the reference solution in every instance, of which the best replaces it when it is better.
// What the paper leaves open (how small "small random amounts" are, how large cells and shapes are)
// is said in PatternSearch::Options::Paper. Fills `instances`, colours and groups aside. The result
// does not depend on `threads`.
PatternSearch::Summary searchByPaper(const SearchSpace& space, std::vector<ShapeInstance>& instances, int threads,
                                     const PatternSearch::AskStop& askStop);

// p_cre of a lattice cell and p_del of an instance cell with difference index g; 0 where g does not
// pass the threshold.
double createProbability(double g, double lambdaCreate);
double deleteProbability(double g, double lambdaDelete);

}  // namespace fantascope::pattern
