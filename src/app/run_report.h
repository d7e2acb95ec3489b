#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/clock.h"

namespace fantascope::app {

// The middle, the slowest hundredth and the worst of a set of durations.
struct Quantiles {
    std::size_t count = 0;
    double p50 = 0, p99 = 0, max = 0;
};
// By the nearest rank; all zero for no values.
Quantiles quantilesOf(std::vector<double> values);

// What one output did in a run.
struct OutputReport {
    std::string name;
    std::int64_t frames = 0;      // shown
    std::int64_t lateFrames = 0;  // refreshes that passed between the one that a frame was for and the one that showed it
    std::vector<double> frameMs;  // from the start of drawing to the picture being ready for its refresh
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
    std::vector<double> inputToFrameMs;  // from a button's arrival to the first refresh that shows its effect
    std::vector<double> dmxIntervalMs;   // between frames of a universe
    std::int64_t yardstickTicks = 0, yardstickLate = 0;  // an empty thread at the leading output's rate: what the machine itself misses
    std::vector<CueReport> cues;
    std::vector<FaultReport> faults;
    std::map<std::string, std::vector<std::pair<Time, double>>> zCamera;  // per output
    std::string stopReason;
};

// The keys are documented in docs/report.md.
nlohmann::ordered_json jsonOf(const RunReport& report);

}  // namespace fantascope::app
