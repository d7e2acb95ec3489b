#pragma once

#include "app/base/report.h"

#include "plot/night_figure.h"

#include <optional>

namespace fantascope::app {

// Whether it is the report of a run or a rehearsal, as far as its keys tell.
bool isNight(const Report& report);

// What the figure needs of it. A series that the report lacks is empty. Nothing: a value has
// another type than docs/report.md says.
std::optional<plot::Night> nightOf(const Report& report);

}  // namespace fantascope::app
