#pragma once

#include "show/cue_list.h"
#include "show/show.h"
#include "show/site/site.h"

#include "core/result.h"

namespace fantascope::show {

// A show's lists with every name looked up in one site. `lengths`: of its sources; null: they are
// not known, and a follow that counts from the end of what plays counts from the end of the fade.
// Error: place in the show file, and what the site has instead.
Result<CueList> bound(const Show& show, const Site& site, const PlayLengths* lengths);

}  // namespace fantascope::show
