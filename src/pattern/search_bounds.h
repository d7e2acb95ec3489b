#pragma once

#include "pattern/pattern_search.h"

namespace fantascope::pattern {

// The numbers of PatternSearch::Options, each with its key and bounds, section by section as in a settings file. `fields` has
// number(), integer() and angle() as ConfigFields has them: one reads them from a file, another tests those of a program.
template <class Fields>
void declareSearch(Fields& fields, PatternSearch::Options& options) {
    fields.number("target_z", options.targetZ, 0, 1);
    fields.integer("rows", options.rows, 16, 4096);
    fields.number("lambda_create", options.lambdaCreate, -1, 1);
    fields.number("lambda_increase", options.lambdaIncrease, -1, 1);
    fields.number("lambda_reduce", options.lambdaReduce, -1, 1);
    fields.number("lambda_delete", options.lambdaDelete, -1, 1);
    fields.number("lattice_cell", options.latticeCell, 0.1, 100);
    fields.number("instance_cell", options.instanceCell, 0.1, 100);
    fields.integer("candidates", options.candidates, 1, 1000);
    fields.number("largest_amount", options.largestAmount, 0, 10);
    fields.number("success_rate", options.successRate, 0.01, 0.99);
}

template <class Fields>
void declareShapes(Fields& fields, PatternSearch::Options& options) {
    fields.integer("instances", options.instances, 1, 100'000);
    fields.angle("tilt", options.tilt, 0, 180);
    fields.angle("turn", options.turn, 0, 180);
}

}  // namespace fantascope::pattern
