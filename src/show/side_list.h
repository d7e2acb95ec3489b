#pragma once

#include "show/cue.h"

#include "core/config/config.h"
#include "core/config/file_place.h"
#include "core/result.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::show {

// A list of cues that plays beside the show's own, as its author wrote it.
struct SideList {
    FilePlace at;
    std::string name;
    std::vector<Cue> cues;
    std::optional<std::size_t> start;  // index into `cues`: entered when the show leaves the dark; none: it waits for an input
    bool loops = false;                // the first cue comes after the last
};

// Reads the lists beside the show's own, and notes their names in `rules`. Error: file, line,
// column, key, advice, for all faults.
Result<std::vector<SideList>> readSides(const ConfigNode& node, CueRules& rules);

}  // namespace fantascope::show
