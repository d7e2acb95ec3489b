#pragma once

#include "app/devices.h"
#include "app/playback_replica.h"
#include "app/run_report.h"

#include "render/frame_tap.h"
#include "render/output_renderer.h"
#include "show/site.h"

#include "core/latest_value.h"

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace fantascope::app {

// The render thread's work: frame after frame it asks the playback what is to be seen when the next refresh takes place, draws that on
// every output and shows it. The first running display leads: its refresh paces the loop; the others follow within the same refresh. A
// display that is lost is left out until it is back. A display that holds a finished frame lets the loop be a frame ahead. Thread: bound to the render thread, but for the slots and counters.
class FrameLoop {
public:
    // All outlive it. `assets`: the folder of the shaders.
    FrameLoop(const show::Site& site, const show::CueList& cues, std::vector<render::PictureSource> sources,
              std::filesystem::path assets, Devices& devices, Clock& clock);
    ~FrameLoop();

    PlaybackReplica& replica() { return replica_; }
    // A further reader of the frames that `output` shows. Before the first frame.
    render::FrameReader& tap(std::size_t output);
    // The state of the newest frame goes into this slot too. Before the first frame.
    void publishStateTo(LatestValue<show::ShowState>& slot) { stateSlot_ = &slot; }

    // Makes the renderers of the displays that are there and draws every source once, so that nothing is compiled while people watch.
    // Error: a renderer cannot be made for a display.
    Result<void> prepare();
    // The first refresh at or after a moment; a show that begins with one has a whole period for its first frame.
    Time refreshFrom(Time moment);
    // Show time 0 is `start` on the clock. Before the first frame.
    void begin(Time start);
    // The moment that the next frame is for: the first refresh that can still be met.
    Time nextDue();
    // One frame on every output; returns when another can be made. Error: a renderer cannot be made for a display.
    Result<void> step();
    // The show is over: refreshes up to `end` that no frame was made for count as late. After the last frame.
    void finish(Time end);

    // Counters for the progress line. Thread-safe.
    std::int64_t framesShown() const { return framesShown_; }
    std::int64_t framesLate() const { return framesLate_; }
    // After the last frame.
    const std::vector<OutputReport>& outputs() const { return reports_; }
    const Durations& inputToFrame() const { return inputToFrame_; }

private:
    struct Output {
        const show::Output& site;
        DisplaySink& display;
        std::unique_ptr<render::OutputRenderer> renderer{};  // made when the display is first there
        std::optional<render::FrameTap> tap{};               // where somebody reads
        bool drawn = false;                                  // in the frame that is being made
        std::optional<Time> shown{};                         // when the newest frame was, or will be; none since it was lost
    };
    Result<void> makeRenderer(Output& output);
    Result<void> draw(Output& output, std::size_t index, Time showTime, OutputReport& report);
    Output* leader();
    void countLate(std::size_t output, std::int64_t refreshes);

    std::vector<render::PictureSource> sources_;
    std::filesystem::path assets_;
    Clock& clock_;
    Time start_{};
    Time newest_{};  // the moment that the newest frame is for
    PlaybackReplica replica_;
    show::ShowState state_;
    std::vector<Output> outputs_;
    LatestValue<show::ShowState>* stateSlot_ = nullptr;
    std::vector<OutputReport> reports_;
    Durations inputToFrame_;
    std::atomic<std::int64_t> framesShown_ = 0, framesLate_ = 0;
};

}  // namespace fantascope::app
