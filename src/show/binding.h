#pragma once

#include "show/cue_list.h"
#include "show/show.h"
#include "show/site/site.h"

#include "core/result.h"

namespace fantascope::show {

// A show's lists with every name looked up in one site. Error: place in the show file, and what the
// site has instead.
Result<CueList> bound(const Show& show, const Site& site);

}  // namespace fantascope::show
