#pragma once

#include "app/base/durations.h"
#include "app/base/report.h"

#include "show/event.h"

#include "core/clock.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::app {

// Where the time of an output's frame goes. docs/report.md has their names.
enum class FramePart {
    Upload,  // instances and pictures to the GPU
    Render,  // drawing and its completion
    Swap     // handing the picture to the display, without the wait for its refresh
};
constexpr std::size_t kFrameParts = 3;
using PartTimes = std::array<Time, kFrameParts>;

// What made a refresh pass without a frame of its own, by what the thread did since the frame
// before, on all outputs: the part that took longest, where all together took more than a refresh's
// period. Nothing: the thread had time, and the machine did not run it.
std::optional<FramePart> causeOfDelay(const PartTimes& spent, Time period);

// What one output did in a run.
struct OutputReport {
    std::string name;
    std::int64_t frames = 0;                         // shown
    std::array<std::int64_t, kFrameParts> lateBy{};  // refreshes without a frame of their own, by the part that made them so
    std::int64_t lateByMachine = 0;                  // and by none
    std::array<Durations, kFrameParts> took{};       // of each frame shown
    std::optional<std::int64_t> recorded{};          // of the frames shown; nothing where no recording is made

    std::int64_t lateFrames() const { return std::accumulate(lateBy.begin(), lateBy.end(), lateByMachine); }
};

struct CueReport {
    std::string name;
    Time entered{};
};

// The cues as they were entered.
std::vector<CueReport> cuesOf(const show::EventLog& events);

struct FaultReport {
    Time at{};
    std::string what;
    std::string device{};         // by its name in the site file; empty: none
    std::optional<Time> until{};  // nothing: to the end, or it has no length
};

// A bank of relays whose safe states are not confirmed.
struct UnsafeBank {
    std::string name, why;
};
// A universe whose lamps did not get their end levels.
struct UnendedLine {
    int universe;
    std::string why;
};
// What to tell the operator of relays that were not made safe: which, why, and what to do.
std::string sentenceOf(const std::vector<UnsafeBank>& unsafe);
std::string sentenceOf(const UnendedLine& line);

// What a run has to say of itself. Every figure is a measurement of that run; times are show time.
struct RunReport {
    Time length{};
    std::uint64_t seed = 0;
    std::int64_t frames = 0, lateFrames = 0;  // on all outputs
    std::vector<OutputReport> outputs;
    Durations swapSkew;      // between the first and the last output's swap of one frame
    Durations inputToFrame;  // from a button's arrival to the first refresh that shows its effect
    Durations dmxInterval;   // between the lamps' frames
    std::int64_t yardstickTicks = 0,
                 yardstickLate = 0;  // an empty thread at the first output's rate: what the machine itself misses
    std::vector<CueReport> cues;
    std::vector<FaultReport> faults;
    std::map<std::string, std::vector<std::pair<Time, double>>> zCamera;      // per output
    std::map<std::string, std::int64_t> lateVideoFrames, damagedVideoFrames;  // per source that is a video
    std::map<std::string, std::int64_t> lostFrames;                           // per output, of a recording that was not finished
    std::vector<UnsafeBank> unsafe;
    std::string stopReason;
    std::string hung;  // why the program did not wait for the render thread; empty: it came back
};

// All late frames by what made them so: "3 render, 1 machine"; empty where none was late.
std::string lateFramesByCause(const std::vector<OutputReport>& outputs);
// The keys stand in docs/report.md.
Report jsonOf(const RunReport& report);

}  // namespace fantascope::app
