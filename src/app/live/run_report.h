#pragma once

#include "app/base/durations.h"
#include "app/base/report.h"
#include "app/parts/fault_log.h"
#include "app/watch/drift_watch.h"
#include "drivers/site/simulated_site.h"

#include "show/play/event.h"
#include "show/play/show_clock.h"

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

// What takes the time of an output's frame. docs/report.md has the names of these parts.
enum class FramePart {
    Upload,  // instances and pictures to the GPU
    Render,  // drawing and its completion
    Swap     // handing the picture to the display, without the wait for its refresh
};
constexpr std::size_t kFrameParts = 3;
using PartTimes = std::array<Time, kFrameParts>;

// The cause of a late frame. `spent` is the thread's work since the previous frame, on all outputs.
// If the sum exceeds a refresh period, the cause is the longest part. Otherwise the result is
// nothing: the thread had time, but the machine did not run it.
std::optional<FramePart> causeOfDelay(const PartTimes& spent, Time period);

// What one output did in a run.
struct OutputReport {
    std::string name;
    std::int64_t frames = 0;                         // shown
    std::array<std::int64_t, kFrameParts> lateBy{};  // refreshes without a new frame, by the part that caused them
    std::int64_t lateByMachine = 0;                  // refreshes without a new frame that no part caused
    std::array<Durations, kFrameParts> took{};       // of each frame shown, by part
    std::optional<std::int64_t> recorded{};          // how many of the frames shown; none: there is no recording

    std::int64_t lateFrames() const { return std::accumulate(lateBy.begin(), lateBy.end(), lateByMachine); }
};

struct CueReport {
    std::string name;
    Time entered{};
    std::string list{};  // the side list; empty: the main one
};

// What was told of the patterns, and when.
using PatternNews = std::vector<std::pair<Time, show::event::PatternFitted>>;

// A relay bank that has not confirmed its safe states.
struct UnsafeBank {
    std::string name, why;
};
// A universe whose fixtures did not get their end levels.
struct UnendedLine {
    int universe;
    std::string why;
};
// Tells the operator which relays were not made safe, why, and what to do.
std::string sentenceOf(const std::vector<UnsafeBank>& unsafe);
std::string sentenceOf(const UnendedLine& line);
// Tells the operator of a run that hung: why, what became of relays and lamps, and whether its
// recording is lost.
std::string hungSentence(const std::string& why, const std::vector<UnsafeBank>& unsafe, const std::vector<UnendedLine>& unended,
                         bool recordingIsLost);

// The report of a run. Every figure was measured in that run; times are show time.
struct RunReport {
    Time length{};
    std::uint64_t seed = 0;
    std::int64_t frames = 0, lateFrames = 0;  // on all outputs
    std::vector<OutputReport> outputs;
    Durations swapSkew;                // between the first and the last output's swap of one frame
    Durations inputToFrame;            // from a button's arrival to the first refresh that shows its effect
    Durations dmxInterval;             // between DMX frames
    std::optional<Time> startToFrame;  // from the start of the program until every output showed its first frame
    std::int64_t yardstickTicks = 0,
                 yardstickLate = 0;    // of an empty thread at the first output's rate: what the machine itself misses
    std::optional<CueReport> resumed;  // the cue and the time at which the run went on; none: it began
    std::map<std::string, std::int64_t> inputsBySource, inputsByOutcome;
    std::vector<CueReport> cues;
    std::vector<FaultReport> faults;
    PatternNews patterns;                            // how they were fitted to the wall, or would have been
    std::vector<show::event::LightCorrected> light;  // what the light correction did, or would have done
    std::map<std::string, std::vector<std::pair<Time, double>>> zCamera, toneCamera, iouCamera;  // per output
    std::vector<LampReport> lamps;                                                               // empty: none may be trimmed
    std::vector<CauseReport> causes;                                          // why the wall is not as it should be
    std::map<std::string, std::vector<DriftReport>> watch;                    // per output
    std::map<std::string, std::int64_t> lateVideoFrames, damagedVideoFrames;  // per source that is a video
    std::map<std::string, std::int64_t> lostFrames;                           // per output, of a recording that was not finished
    std::vector<UnsafeBank> unsafe;
    std::string stopReason;
    std::string hung;  // why the program did not wait for the render thread; empty: the thread ended in order
};

// Adds what the events tell of cues, of the light correction and of patterns, in their order.
void addEvents(const show::EventLog& events, RunReport& report);

// Adds what happened at the simulated site, in the order of the times.
void addHappenings(const std::vector<site::Happening>& happenings, const show::ShowClock& showClock, RunReport& report);

// All late frames by cause: "3 render, 1 machine"; empty if none was late.
std::string lateFramesByCause(const std::vector<OutputReport>& outputs);
// The report as JSON. docs/report.md describes the keys.
Report jsonOf(const RunReport& report);

}  // namespace fantascope::app
