#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pattern/shape_pattern.h"

namespace fantascope::pattern {

// How many movement groups a pattern of `instances` has: the nearest whole number of groups of `instancesPerGroup`, at least 1.
std::uint32_t groupCount(std::size_t instances, double instancesPerGroup);

// Arranges instances into groups by fuzzy c-means over their centres (Bezdek 1981) and a draw per instance from its row of the membership
// matrix (Ji et al. 2015, section 4.2, stage 2, step 1). The draw of each instance comes from the stream (seed, its id).
// Sets pattern.groups and every instance's group.
void assignGroups(ShapePattern& pattern);

}  // namespace fantascope::pattern
