#pragma once

#include "app/base/report.h"

#include "show/schedule/nights.h"
#include "show/show.h"

#include <string>

namespace fantascope::app {

// Some nights of a show's schedule.
struct Season {
    const show::Show& show;
    const show::Nights& nights;
    show::Date first;
    int count = 0;
};

// A line for each moment: the night, its sunset, when which cue begins and ends, and why a night is
// dark. Times are by the clocks of the place.
std::string tableOf(const Season& season);
// The same for programs. docs/report.md describes the keys.
Report jsonOf(const Season& season);

}  // namespace fantascope::app
