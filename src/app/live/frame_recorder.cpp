#include "app/live/frame_recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace fantascope::app {
namespace {

// How far a recording may be behind each output: so many bytes of frames, but at least a few
// frames.
constexpr std::size_t kQueueBytes = std::size_t{256} << 20, kLeastQueue = 4, kMostQueue = 240;
constexpr double kTablesRate = 1;  // Hz

}  // namespace

FrameRecorder::FrameRecorder(Recording& recording, const show::Site& site, FrameLoop& frames, Clock& clock, FaultLog& faults,
                             std::function<void()> advanced)
    : recording_(recording), clock_(clock), faults_(faults), advanced_(std::move(advanced)), rate_(site.outputs[0].refreshRate) {
    for (std::size_t output = 0; output < site.outputs.size(); ++output) {
        const glm::ivec2 size = site.outputs[output].size();
        const std::size_t bytes = sizeof(Rgba8) * static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y);
        outputs_.push_back(
            {site.outputs[output].name, &frames.tap(output).addQueue(std::clamp(kQueueBytes / bytes, kLeastQueue, kMostQueue))});
    }
}

void FrameRecorder::begin(Time runStart) {
    runStart_ = runStart;
    recording_.begin(runStart);
}

std::vector<Part> FrameRecorder::parts() {
    std::vector<Part> parts;
    const Time phase = runStart_ + tickTime(1, 2 * rate_);  // half a refresh period after the frames become visible
    for (const Video& video : recording_.videos())
        parts.push_back({"recording", rate_, phase, [this, video](Time moment) { record(video, moment); }, Rank::Watch});
    return parts;
}

Part FrameRecorder::tables() {
    return {"tables", kTablesRate, runStart_,
            [this](Time moment) {
                for (const Error& error : recording_.writeTables())
                    faults_.raise(moment, "", FaultLog::Topic::Recording,
                                  "recording: " + error.message() + "; the show goes on without this table");
            },
            Rank::Watch};
}

void FrameRecorder::record(Time moment) {
    for (const Video& video : recording_.videos()) record(video, moment);
}

// Records the frames that became visible until a moment and are not recorded yet, the oldest first,
// whatever their output.
void FrameRecorder::record(const Video& video, Time moment) {
    for (;;) {
        Output* oldest = nullptr;
        Time first = Time::max();
        for (const std::size_t output : video)
            if (const auto at = outputs_[output].frames->nextAt(moment); at && *at < first) {
                oldest = &outputs_[output];
                first = *at;
            }
        if (oldest == nullptr) break;
        const render::ShownFrame* const frame = oldest->frames->next(moment);
        if (frame == nullptr) continue;  // the frame's context has been lost
        const Result<void> written = recording_.frame(frame->output, frame->image, frame->shown, frame->showTime);
        if (!written)
            tell(frame->shown.at, frame->output, FaultLog::Topic::Recording,
                 written.error().message() + "; the show goes on without this video");
        advanced_();
    }
    for (const std::size_t output : video) {
        Output& recorded = outputs_[output];
        if (recorded.frames->missed() == 0 || std::exchange(recorded.saidMissing, true)) continue;
        tell(clock_.now(), output, FaultLog::Topic::RecordedFrames,
             fmt::format("this machine is too busy to record every frame of '{}'; the show goes on", recorded.name));
    }
}

void FrameRecorder::finish(Time moment, std::vector<OutputReport>& outputs) {
    record(Time::max());  // the last frames may have become visible after the parts had ended
    if (const Result<void> finished = recording_.finish(); !finished)
        faults_.raise(moment, "", FaultLog::Topic::Recording, "recording: " + finished.error().message());
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        OutputReport& output = outputs[i];
        output.recorded = recording_.recorded(i);
        if (*output.recorded < output.frames)
            tell(
                moment, i, FaultLog::Topic::RecordedFrames,
                fmt::format("{} of {} frames of '{}' are missing", output.frames - *output.recorded, output.frames, output.name));
    }
}

void FrameRecorder::tell(Time moment, std::size_t output, FaultLog::Topic topic, const std::string& what) {
    faults_.raise(moment, outputs_[output].name, topic, "recording: " + what);
}

}  // namespace fantascope::app
