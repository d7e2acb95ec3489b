#pragma once

#include "show/site/site_fields.h"

#include <set>
#include <string>

namespace fantascope::show {

// Reads one entry of a site's `outputs`. Its canvas is empty if the file names none. `names`: of
// the outputs so far; the function adds this output's name. Error: place, key, advice.
Result<Output> readOutput(const ConfigNode& node, std::set<std::string>& names, DriversWord& drivers);

}  // namespace fantascope::show
