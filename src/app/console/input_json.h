#pragma once

#include "app/base/report.h"

#include "show/play/input.h"
#include "show/revision.h"

#include "core/result.h"

namespace fantascope::app {

// What a person at a page, or a script, asks of a show: {"do": "jump", "cue": "2.5"}. docs/api.md
// has all of it. The input has no time and no source yet. Error: what is wrong with it.
Result<show::Input> inputFrom(const Report& wish, const show::Revision& revision);

}  // namespace fantascope::app
