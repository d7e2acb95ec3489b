#pragma once

#include "app/live/playback_replica.h"

#include "render/frame_tap.h"
#include "show/event.h"
#include "show/show.h"
#include "show/show_clock.h"

#include "core/clock.h"
#include "core/result.h"

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

namespace fantascope::app {

// What every output shows at one moment, as PNG files, whenever the operator wants it:
//   00012.400s-2-First-light-left.png   show time, the cue's number and name, the output
// The pixels are those that the display was given. Thread: take() from any thread; all else from
// one.
class Screenshots {
public:
    // All outlive it, but for the clock. `frames` of each output: those alone that are asked for.
    // The folder is made with the first picture. Where a picture is, or why there is none, goes to
    // `events`.
    Screenshots(std::filesystem::path folder, const show::Show& show, const show::InputLog& inputs,
                const std::vector<std::string>& outputs, const std::vector<render::NewestFrame*>& frames,
                const show::ShowClock& showClock, show::EventLog& events);

    // How often it looks for what was asked for.
    static constexpr double kRate = 20;
    // A picture of every output, a moment later in the show. Another call before they are taken
    // takes another one.
    void take() { wanted_ = true; }
    void tick(Time moment);

private:
    struct Output {
        std::string name;
        render::NewestFrame* frames;
        bool awaited = false;
    };
    Result<std::filesystem::path> write(const std::string& output, const render::ShownFrame& frame);

    const std::filesystem::path folder_;
    const show::Show& show_;
    const show::ShowClock showClock_;
    show::EventLog& events_;
    PlaybackReplica replica_;  // names the cue of a frame
    show::ShowState state_;
    std::vector<Output> outputs_;
    Time from_{};   // show time of the frames that were asked for
    Time until_{};  // the moment at which nobody waits for them any more
    std::atomic<bool> wanted_ = false;
};

}  // namespace fantascope::app
