#pragma once

#include "pattern/shape/shape_pattern.h"
#include "render/source/picture_source.h"

#include "core/clock.h"
#include "core/result.h"

#include <chrono>
#include <cstddef>

namespace fantascope::app {

// A light pattern whose drawing was saved: the search goes on from the pattern that is shown, for a
// short while. Shapes come, go and move where the drawing has changed, and all others stay.
struct RedrawnPattern {
    render::PatternSource source;                    // with the pattern
    std::size_t made = 0, removed = 0, changed = 0;  // instances
    double toneBefore = 0, toneAfter = 0;            // difference from the drawing, seen from afar, of full light

    static constexpr Time kSearch = std::chrono::seconds(1);
    // `shown`: its guide is the drawing that was saved. Error: the drawing cannot be read or has
    // another shape, or the pattern was not compared in light.
    static Result<RedrawnPattern> of(const pattern::ShapePattern& shown);
};

}  // namespace fantascope::app
