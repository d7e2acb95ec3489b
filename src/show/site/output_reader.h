#pragma once

#include "show/site/site_fields.h"

#include <set>
#include <string>

namespace fantascope::show {

// One entry of a site's `outputs`. Its canvas is empty if the file names none. `names`: of the
// outputs so far, to which it adds its own. Error: place, key, advice.
Result<Output> readOutput(const ConfigNode& node, std::set<std::string>& names, DriversWord& drivers);

}  // namespace fantascope::show
