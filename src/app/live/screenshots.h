#pragma once

#include "render/frame_tap.h"
#include "show/play/event.h"
#include "show/play/playback_replica.h"
#include "show/play/show_clock.h"
#include "show/played_show.h"

#include "core/clock.h"
#include "core/result.h"

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

namespace fantascope::app {

// Writes what every output shows at one moment to PNG files, whenever the operator asks for it:
//   00012.400s-2-First-light-left.png   show time, the cue's number and name, the output
// The pixels are those that the display was given. Thread: take() from any thread; all else from
// one.
class Screenshots {
public:
    // All arguments by reference outlive this, except `showClock`. `frames`: a reader for each
    // output, which reads only frames that are asked for. The folder is created with the first
    // picture. Events report each picture's file, or why there is no picture.
    Screenshots(std::filesystem::path folder, const show::PlayedShow& show, const show::InputLog& inputs,
                const std::vector<std::string>& outputs, const std::vector<render::NewestFrame*>& frames,
                const show::ShowClock& showClock, show::EventLog& events);

    // Hz; how often it checks for requests.
    static constexpr double kRate = 20;
    // Asks for a picture of every output, a moment later. A call while pictures are being taken
    // asks for another set.
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
    const show::PlayedShow& show_;
    const show::ShowClock showClock_;
    show::EventLog& events_;
    show::PlaybackReplica replica_;  // finds the cue of a frame
    show::ShowState state_;
    std::vector<Output> outputs_;
    Time from_{};   // show time of the frames that were asked for
    Time until_{};  // the moment at which the wait for them ends
    std::atomic<bool> wanted_ = false;
};

}  // namespace fantascope::app
