#pragma once
// A running show as JSON: what docs/api.md describes.

#include "app/base/report.h"

#include "show/play/playback.h"
#include "show/revision.h"
#include "show/show_state.h"

#include <string>

namespace fantascope::app {

// All cues of a show: of its own list first, then of the lists beside it.
Report cuesJson(const show::Revision& revision);

// What a page shows of a moment. Everything in it stays the same until something happens: times to
// come are in cue time, seconds, so that a page counts down by itself. `playback`: after the inputs
// that `state` has.
Report stateJson(const show::ShowState& state, const show::Playback& playback, const show::Revision& revision);

// What the lamps and relays do at a moment, and what a person holds of them.
Report lightsJson(const show::ShowState& state, const show::Revision& revision);

// What a page counts by: show time and cue time of a moment, seconds, and whether cue time goes on.
Report clockJson(const show::ShowState& state, const show::Playback& playback);

}  // namespace fantascope::app
