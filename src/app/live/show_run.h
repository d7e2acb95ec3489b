#pragma once

#include "app/base/interrupt.h"
#include "app/live/run_console.h"
#include "app/live/run_report.h"
#include "app/site/devices.h"

#include "show/schedule/night_time.h"

#include "core/result.h"
#include "web/server.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace fantascope::app {

// How to run a show.
struct RunOptions {
    std::filesystem::path show;  // a folder or a show.yaml
    std::filesystem::path site;  // a folder or a site.yaml
    Backends backends = Backends::AsDeclared;
    std::optional<Time> length;                              // none: until interrupted
    std::optional<show::DateAndTime> at;                     // by the place's clocks, as if the run began then; none: now
    std::string fromCue;                                     // enter this cue at once; empty: wait for the first GO in the dark
    std::filesystem::path recordTo;                          // empty: no recording; see Recording
    std::filesystem::path pictures = "fantascope-pictures";  // the folder for the operator's pictures; see Screenshots
    std::filesystem::path report;                            // a JSON file; empty: no report
    std::filesystem::path journal;                           // the folder of the nights' journals; empty: none is kept
    bool asFastAsPossible = false;                           // on a stepped clock: the same bytes every time. It needs a length
    std::optional<web::Server::Options> page;  // where the page of the run is; none: there is no page. Not on a stepped clock
    bool handsOff = false;                     // the simulated controller presses GO by itself, evenly over the length
    std::uint64_t seed = 1;                    // of the simulated site's noise
};

// Runs a show from its files to its report. It claims the site and its devices, opens the devices,
// or the simulated site and its devices, and gives every part its thread, or the stepped clock its
// parts. It draws on the calling thread, which becomes the render thread, until the length is over
// or `interrupt` is requested. Then relays take their safe states, and fixtures their end levels.
// RunReport::unsafe names the banks that may be unsafe. `progress` is called about every half
// second. The loss of a device during the run is no error.
// Error: another program has claimed the site or one of its devices; a file or a driver refuses,
// and nothing has been shown; the report cannot be written. A run whose render thread hangs does
// not return: the Supervisor ends the program.
Result<RunReport> runShow(const RunOptions& options, const Interrupt& interrupt,
                          const std::function<void(const RunStatus&)>& progress);

}  // namespace fantascope::app
