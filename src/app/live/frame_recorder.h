#pragma once

#include "app/live/frame_loop.h"
#include "app/live/recording.h"
#include "app/live/run_report.h"
#include "app/parts/fault_log.h"
#include "app/parts/part.h"

#include "render/frame_tap.h"
#include "show/site/site.h"

#include "core/clock.h"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace fantascope::app {

// Brings every frame that the outputs show into a recording. Frames that are missing from it are
// reported as faults, and the show goes on.
// Thread: a video's part on one thread; the rest on the render thread. No part runs during record()
// and finish().
class FrameRecorder {
public:
    // All arguments by reference outlive this. Construct it before FrameLoop::prepare(), because it
    // reads every output's frames from the first one on. `advanced` is called after each frame, on
    // the thread that recorded it.
    FrameRecorder(Recording& recording, const show::Site& site, FrameLoop& frames, Clock& clock, FaultLog& faults,
                  std::function<void()> advanced);

    // Sets the moment at which the videos begin. Call it before the first frame.
    void begin(Time runStart);
    // The parts for real time: one for each video, so that a slow one does not hold up the others.
    std::vector<Part> parts();
    // The part, for either clock, that writes the recording's tables to the disk now and then.
    Part tables();
    // Records the frames that became visible until `moment`. For the stepped clock, instead of
    // parts(): call it after each frame. The show waits for it, so no frame is left out.
    void record(Time moment);
    // Ends the files at `moment`, reports what is missing from them, and sets the counts in
    // `outputs`, the outputs' reports.
    void finish(Time moment, std::vector<OutputReport>& outputs);

private:
    // An output's frames on their way.
    struct Output {
        std::string name;
        render::FrameQueue* frames;
        bool saidMissing = false;
    };
    using Video = std::vector<std::size_t>;  // the outputs that it shows
    void record(const Video& video, Time moment);
    void tell(Time moment, std::size_t output, FaultLog::Topic topic, const std::string& what);

    Recording& recording_;
    Clock& clock_;
    FaultLog& faults_;
    const std::function<void()> advanced_;
    const double rate_;  // Hz, the leading output's
    Time runStart_{};
    std::vector<Output> outputs_;  // each belongs to the thread of its video
};

}  // namespace fantascope::app
