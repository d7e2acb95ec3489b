#pragma once

#include "app/durations.h"
#include "app/report.h"

#include "core/clock.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace fantascope::app {

// What one output did in a run.
struct OutputReport {
    std::string name;
    std::int64_t frames = 0;      // shown
    std::int64_t lateFrames = 0;  // refreshes that passed between the one that a frame was for and the one that showed it
    Durations frame{};            // from the start of drawing to the picture being ready for its refresh
};

struct CueReport {
    std::string name;
    Time entered{};
};

struct FaultReport {
    Time at{};
    std::string what;
};

// What a run has to say of itself. Every figure is a measurement of that run; times are show time.
struct RunReport {
    Time length{};
    std::uint64_t seed = 0;
    std::vector<OutputReport> outputs;
    Durations inputToFrame;  // from a button's arrival to the first refresh that shows its effect
    Durations dmxInterval;   // between the lamps' frames
    std::int64_t yardstickTicks = 0,
                 yardstickLate = 0;  // an empty thread at the first output's rate: what the machine itself misses
    std::vector<CueReport> cues;
    std::vector<FaultReport> faults;
    std::map<std::string, std::vector<std::pair<Time, double>>> zCamera;  // per output
    std::string stopReason;
};

// The keys stand in docs/report.md.
Report jsonOf(const RunReport& report);

}  // namespace fantascope::app
