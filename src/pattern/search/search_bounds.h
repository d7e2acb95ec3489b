#pragma once

#include "pattern/search/pattern_search.h"

#include <limits>

namespace fantascope::pattern {

// The numbers of PatternSearch::Options, each with its key and bounds, in the sections of a
// settings file. `fields` has number(), integer() and angle() as ConfigFields has. One kind of
// Fields reads them from a file, another checks values that a program has set.
template <class Fields>
void declareSearch(Fields& fields, PatternSearch::Options& options) {
    fields.number("target_z", options.targetZ, 0, 1);
    fields.integer("iterations", options.iterations, 0, std::numeric_limits<int>::max());
    fields.integer("rows", options.rows, 16, 4096);
}

template <class Fields>
void declareRefined(Fields& fields, PatternSearch::Options::Refined& refined) {
    fields.number("z_weight", refined.zWeight, 0, 100);
    fields.number("tone_weight", refined.toneWeight, 0, 100);
    fields.number("overlap_weight", refined.overlapWeight, 0, 100);
    fields.number("overlap_free", refined.overlapFree, 0, 1);
    fields.number("temperature", refined.temperature, 0, 10);
    fields.number("polish", refined.polish, 0, 1);
}

template <class Fields>
void declarePaper(Fields& fields, PatternSearch::Options::Paper& paper) {
    fields.number("lambda_create", paper.lambdaCreate, -1, 1);
    fields.number("lambda_increase", paper.lambdaIncrease, -1, 1);
    fields.number("lambda_reduce", paper.lambdaReduce, -1, 1);
    fields.number("lambda_delete", paper.lambdaDelete, -1, 1);
    fields.number("lattice_cell", paper.latticeCell, 0.1, 100);
    fields.number("instance_cell", paper.instanceCell, 0.1, 100);
    fields.integer("candidates", paper.candidates, 1, 1000);
    fields.number("largest_amount", paper.largestAmount, 0, 10);
    fields.number("success_rate", paper.successRate, 0.01, 0.99);
}

template <class Fields>
void declareShapes(Fields& fields, PatternSearch::Options& options) {
    fields.integer("instances", options.instances, 1, 100'000);
    fields.angle("tilt", options.tilt, 0, 180);
    fields.angle("turn", options.turn, 0, 180);
}

template <class Fields>
void declareShape(Fields& fields, PatternSearch::Options::Shape& shape) {
    fields.number("share", shape.share, 0.001, 1000);
}
// The bounds of a shape's own rotations, degrees in both directions.
constexpr double kMaxTilt = 180, kMaxTurn = 360;

}  // namespace fantascope::pattern
