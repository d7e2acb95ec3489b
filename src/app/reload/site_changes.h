#pragma once

#include "show/site/site.h"

#include "core/result.h"

#include <string>
#include <vector>

namespace fantascope::app {

// What a site file that was saved says otherwise than the one that a run began with.
struct SiteChanges {
    bool hasSameOutputs = false;     // in the same order and of the same sizes: their projections can be taken over
    std::vector<std::string> later;  // all else that differs: "fixtures", "outputs[0].display"
};
// Both sites were read without a fault.
Result<SiteChanges> changesOf(const show::Site& began, const show::Site& saved);

}  // namespace fantascope::app
