#pragma once

#include "app/live/fault_log.h"
#include "app/live/frame_loop.h"
#include "app/live/part.h"
#include "app/live/recording.h"
#include "app/live/run_report.h"

#include "render/frame_tap.h"
#include "show/site/site.h"

#include "core/clock.h"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace fantascope::app {

// Brings every frame that the outputs show into a recording, and tells of those that are not in it:
// the show goes on without them.
// Thread: a video's part on one thread; the rest on the render thread, record() and finish() while
// no part runs.
class FrameRecorder {
public:
    // All outlive it. Before FrameLoop::prepare(), since it reads every output's frames from the
    // first one on. `advanced` is called after each frame, on the thread that recorded it.
    FrameRecorder(Recording& recording, const show::Site& site, FrameLoop& frames, Clock& clock, FaultLog& faults,
                  std::function<void()> advanced);

    // The videos begin with the run. Before the first frame.
    void begin(Time runStart);
    // In real time: one for each video, so that one that is slow does not hold up the others.
    std::vector<Part> parts();
    // On either clock: brings the recording's tables to the disk now and then.
    Part tables();
    // On the stepped clock instead of parts(), after each frame: whatever became visible until
    // `moment`. The show waits for it, so that nothing is left out.
    void record(Time moment);
    // Ends the files at `moment`, and tells what is not in them; `outputs`, the outputs' reports,
    // get their counts.
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
    std::vector<Output> outputs_;  // each its video's thread's
};

}  // namespace fantascope::app
