#pragma once

#include "app/calibrate/wanted_file.h"

#include "core/clock.h"
#include "core/result.h"

#include <functional>

namespace fantascope::app {

// Whether a window can be opened in which a person chooses a canvas's place. Error: why not, and
// what to do instead.
Result<void> checkCornerWindow();

// Shows a window in which a person chooses the places of canvases, one after the other
// (app/calibrate/corner_choice.h). `goesOn`: asked again and again; false ends the choice. Returns
// as ChoosePlaces does. Error: the person gave up or ended it, or the window is gone. Thread: the
// main thread.
Result<std::vector<std::array<glm::dvec2, 4>>> choosePlaces(const std::vector<OpenPlace>& places, Clock& clock,
                                                            const std::function<bool()>& goesOn);

}  // namespace fantascope::app
