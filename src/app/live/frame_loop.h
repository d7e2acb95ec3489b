#pragma once

#include "app/live/held_frame.h"
#include "app/live/run_report.h"
#include "app/reload/source_stock.h"
#include "app/site/devices.h"

#include "render/frame_tap.h"
#include "render/output_renderer.h"
#include "show/play/playback_replica.h"
#include "show/play/show_clock.h"
#include "show/site/site.h"

#include "core/latest_value.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace fantascope::app {

// The settings of an output during setting up.
struct OutputSettings {
    Projection projection;
    std::shared_ptr<const render::BlendMap> blend;
    std::shared_ptr<const RgbaImage> overlay, card;  // as OutputRenderer::setUp() takes them; null: none
};

// The render thread's work. For each frame it asks the playback what is seen at the next refresh,
// draws that on every output, and shows it. The first running display leads: its refresh paces the
// loop, and the others follow within the same refresh. A lost display is left out until it is back.
// All pictures of a frame are finished before the first one is shown.
//
// A finished frame waits while there is time to draw it again (held_frame.h). If there was an input
// meanwhile, it is drawn again, so that a press is seen within one and a half periods. Where
// drawing takes too long for that, for kWarmUp at the start, and for kAhead after two late frames
// within kAhead, it goes to the display at once. If the display can hold it, the loop may be a
// frame ahead then, and the machine may be busy elsewhere.
//
// If an output cannot be drawn (a shader is missing, OpenGL has no memory, an exception), that is a
// fault of this output alone. It is left out, and tried again with a back-off from kSoonestRetry to
// kLatestRetry. When a context is lost, the output's renderer is lost too; the next context gets
// another renderer.
// Thread: bound to the render thread, except the slots, the counters and withFaults().
class FrameLoop {
public:
    static constexpr Time kSoonestRetry = std::chrono::seconds(1), kLatestRetry = std::chrono::seconds(32);
    static constexpr Time kAhead = std::chrono::seconds(5), kWarmUp = std::chrono::milliseconds(300);
    // After so long without a frame the loop counts as hanging in a display.
    static constexpr Time kHangs = std::chrono::seconds(5);

    // All arguments by reference outlive the loop. `assets`: the folder of the shaders. `gains`:
    // the light correction of each output, which is faded in from the run's start; null, or absent:
    // none.
    FrameLoop(const show::Site& site, const show::InputLog& inputs, render::PictureSources sources, std::filesystem::path assets,
              Devices& devices, Clock& clock, const std::vector<std::shared_ptr<const GreyImage>>& gains = {});
    // How long the light correction takes to fade in.
    static constexpr Time kLightFade = std::chrono::seconds(5);
    ~FrameLoop();

    // The tap for the frames that `output` shows. Add readers before the first frame, best before
    // prepare().
    render::FrameTap& tap(std::size_t output);
    // Also publishes the state of each new frame to `slot`. Call it before the first frame.
    void publishStateTo(LatestValue<show::ShowState>& slot) { stateSlot_ = &slot; }

    // The slot for new settings of an output. One other thread writes it. Settings take effect with
    // the next frame.
    LatestValue<std::shared_ptr<const OutputSettings>>& settingsOf(std::size_t output) { return *outputs_[output].settings; }

    // What can be drawn. The renderers follow it, one source a frame.
    SourceStock& sources() { return stock_; }

    // Makes the renderers, and draws every source once, so that nothing is compiled while people
    // watch. A display without a context gets its renderer together with its context. Error: no
    // output with a context can be drawn, for example because the installation lacks a file. A
    // fault of only some outputs is no error: withFaults() reports it.
    Result<void> prepare();
    // From now on, a missing renderer is made on a thread of its own, and the display lends its
    // context to that thread. The other outputs miss no frame, however long this takes and whether
    // it succeeds or not. Without this call all outputs wait for the renderer. A stepped clock does
    // not notice the wait, and the recorded bytes are the same every time. Call it before the first
    // frame.
    void makeRenderersAside() { makesAside_ = true; }
    // The first refresh at or after a moment. A show that begins with a refresh has a whole period
    // for its first frame.
    Time refreshFrom(Time moment);
    // From the run's start on, every refresh without a frame counts as late. Call it before the
    // first frame.
    void begin(const show::ShowClock& showClock);
    // The moment of the next frame: the first refresh that can still be met.
    Time nextDue();
    // Makes one frame on every output. Returns when the next frame can be made.
    void step();
    // Ends the show. Refreshes until `end` without a frame count as late, and the taps' readers get
    // the frames that are still on their way. Call it after the last frame.
    void finish(Time end);

    // Adds what the loop knows to `statuses`, which Devices::statuses() gave. A running display
    // becomes Faulted if its picture cannot be drawn, or if the loop hangs in it. It has trouble if
    // it could not follow its newest settings. Thread-safe; never waits for the render thread.
    std::vector<DeviceStatus> withFaults(std::vector<DeviceStatus> statuses) const;

    // Counters for the progress line. Thread-safe.
    std::int64_t framesShown() const { return framesShown_; }  // on all outputs
    std::int64_t framesShown(std::size_t output) const { return framesShownOn_[output]; }
    std::int64_t framesLate() const { return framesLate_; }
    // The figures of the run. Call these after the last frame.
    std::vector<OutputReport> outputs() const;
    const Durations& swapSkew() const { return swapSkew_; }
    const Durations& inputToFrame() const { return inputToFrame_; }
    // Adds these two, and when every output had shown a frame if the clock is the machine's.
    void addTo(RunReport& report, bool isMachineTime) const;

private:
    // An attempt to make an output's renderer while the other outputs are shown.
    struct Making {
        Result<void> made;
        std::atomic<bool> ended = false;  // the context is free again
        std::jthread thread;              // last, so that it ends before the other members are destroyed
    };
    struct Output {
        const show::Output& site;
        DisplaySink& display;
        std::shared_ptr<const render::BlendMap> blend;  // by the site file
        std::shared_ptr<const GreyImage> gain;          // the light correction; null: none
        std::unique_ptr<LatestValue<std::shared_ptr<const OutputSettings>>> settings =
            std::make_unique<LatestValue<std::shared_ptr<const OutputSettings>>>();
        std::unique_ptr<render::OutputRenderer> renderer{};  // made as soon as the display has a context
        std::unique_ptr<render::FrameTap> tap{};             // null: nobody reads the frames
        int context = 0;                                     // the display's context that renderer and tap belong to
        show::PictureShift shift{};                          // of the warp that the renderer has
        bool fresh = false;                                  // the renderer has only the site file's settings
        SourceStock::Taken sources{};                        // what it can draw
        bool faulted = false;                                // the last attempt failed
        Time retryAt{}, pause{};                             // when the next attempt is due; the back-off
        bool bends = false;                                  // the renderer was made for a mesh
        bool running = false;                                // at the last poll
        bool drawn = false;                                  // in the frame that is being made
        PartTimes spent{};                                   // on that frame so far
        std::optional<Shown> shown{};                        // the newest frame; none if the display was lost since
        std::optional<Time> firstShown{};
        PartTimes spentUntilShown{};       // spent_ at that time
        std::unique_ptr<Making> making{};  // while this is set, its thread owns the display and all else here
        OutputReport report{};
    };
    // Replaces the renderer. The old one stays if this fails.
    Result<void> makeRenderer(Output& output, const Projection& projection, const std::shared_ptr<const render::BlendMap>& blend);
    Result<void> beReady(Output& output);
    // Calls beReady(), and turns an exception into an error.
    Result<void> attempt(Output& output);
    void makeAside(Output& output);
    // Notes the result of the newest attempt. Returns whether the output can be drawn now, or at
    // least once its display is there.
    bool settle(Output& output, const Result<void>& made);
    bool ready(Output& output, Time now);  // makes an attempt if one is due
    // Takes an output back if its attempt has ended. Returns whether the output is here and not
    // lent.
    bool isHere(Output& output);
    // Does some work for one output. An exception is a fault of that output alone: the output
    // counts as one that cannot be drawn, and gets another renderer.
    template <class Work>
    void alone(Output& output, const Work& work);
    void giveUp(Output& output, const char* why);
    // Sets or clears ("") the reason why an output cannot be drawn or cannot follow its settings.
    void tell(std::vector<std::string>& faults, const Output& output, const std::string& fault);
    bool becomesCurrent(Output& output) noexcept;
    void forget(Output& output);
    void inHand(const Output& output);
    void followSettings(Output& output, const show::PictureShift& shift);
    void draw(std::size_t output, Time showTime);
    void drawAll(Time showTime);
    bool awaitInput(Time due);
    void finish(Output& output);
    using Presenting = std::function<Result<Shown>(DisplaySink&)>;
    void show(Output& output, const Presenting& present);
    void giveToReaders(Output& output);
    void measureSkew();
    void look();
    Output* leader();
    void spend(Output& output, FramePart part, Time time);
    void countLate(Output& output, std::int64_t refreshes);

    SourceStock stock_;
    std::filesystem::path assets_;
    Clock& clock_;
    show::ShowClock showClock_;
    Time newest_{};       // the moment of the newest frame
    Time oldestInput_{};  // of those that are seen for the first time in it, show time; Time::max(): there is none
    HeldFrame held_;
    Time lateAt_ = -kAhead;  // when a frame was late last
    Time aheadUntil_{};      // until then no frame waits for inputs
    Time warmUntil_{};       // what frames took before says nothing of later ones
    float lightShare_ = 0;   // how far the light correction is faded in with it
    show::PlaybackReplica replica_;
    show::ShowState state_;
    std::vector<Output> outputs_;
    LatestValue<show::ShowState>* stateSlot_ = nullptr;
    bool makesAside_ = false;
    PartTimes spent_{};  // on all frames of all outputs
    Durations swapSkew_;
    Durations inputToFrame_;
    std::atomic<std::int64_t> framesShown_ = 0, framesLate_ = 0;
    std::vector<std::atomic<std::int64_t>> framesShownOn_;  // by output

    mutable std::mutex faultsMutex_;
    std::vector<std::string> faults_;             // by output; "": none
    std::vector<std::string> unfollowed_;         // by output: why it could not follow its settings; "": it did
    std::vector<Time> madeSince_;                 // by output: since when its renderer is made aside; kNever: it is not
    std::atomic<std::size_t> inHand_ = 0;         // the output that the loop works on
    std::atomic<Time::rep> hangsFrom_ = kNotYet;  // on the clock: the moment from which the loop counts as hanging in inHand_
    static constexpr Time::rep kNotYet = Time::max().count();
    static constexpr Time kNever = Time::max();
};

}  // namespace fantascope::app
