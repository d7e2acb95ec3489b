#pragma once

#include "app/live/playback_replica.h"
#include "app/live/run_report.h"
#include "app/site/devices.h"

#include "render/frame_tap.h"
#include "render/output_renderer.h"
#include "show/show_clock.h"
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

// How an output is set while somebody sets it up.
struct OutputSettings {
    Projection projection;
    std::shared_ptr<const render::BlendMap> blend;
    std::shared_ptr<const RgbaImage> overlay, card;  // as OutputRenderer::setUp() takes them; null: none
};

// The render thread's work: frame after frame it asks the playback what is to be seen when the next
// refresh takes place, draws that on every output and shows it. The first running display leads:
// its refresh paces the loop; the others follow within the same refresh. A display that is lost is
// left out until it is back. All pictures of a frame are finished before the first is shown. A
// display that holds a finished frame lets the loop be a frame ahead.
//
// An output that cannot be drawn (a shader is missing, OpenGL has no memory, an exception) is a
// fault of that output alone: it is left out, and tried again with a back-off from kSoonestRetry to
// kLatestRetry. A context that is lost takes the output's renderer along; the next one gets
// another.
// Thread: bound to the render thread, but for the slots, counters and withFaults().
class FrameLoop {
public:
    static constexpr Time kSoonestRetry = std::chrono::seconds(1), kLatestRetry = std::chrono::seconds(32);
    // Without a frame for so long, the loop hangs in a display.
    static constexpr Time kHangs = std::chrono::seconds(5);

    // All outlive it. `assets`: the folder of the shaders.
    FrameLoop(const show::Site& site, const show::InputLog& inputs, render::PictureSources sources, std::filesystem::path assets,
              Devices& devices, Clock& clock);
    ~FrameLoop();

    // Where the frames that `output` shows are read. Readers come before the first frame, best
    // before prepare().
    render::FrameTap& tap(std::size_t output);
    // The state of the newest frame goes into this slot too. Before the first frame.
    void publishStateTo(LatestValue<show::ShowState>& slot) { stateSlot_ = &slot; }

    // New settings of an output, from one other thread: they hold from the next frame on.
    LatestValue<std::shared_ptr<const OutputSettings>>& settingsOf(std::size_t output) { return *outputs_[output].settings; }

    // Makes the renderers, also of displays that are to come, and draws every source once, so that
    // nothing is compiled while people watch. A display that has no context yet gets its renderer
    // with that. Error: no output can be drawn that has a context, such as where the installation
    // lacks a file. A fault of some outputs alone is no error: withFaults() tells of it.
    Result<void> prepare();
    // From now on a renderer that is missing is made on a thread of its own, to which the display
    // lends its context: the other outputs miss no frame, however long that takes and whether it
    // succeeds. Otherwise all wait for it, which a stepped clock does not notice, and the bytes are
    // the same every time. Before the first frame.
    void makeRenderersAside() { makesAside_ = true; }
    // The first refresh at or after a moment; a show that begins with one has a whole period for
    // its first frame.
    Time refreshFrom(Time moment);
    // Refreshes after the run's start are to be met. Before the first frame.
    void begin(const show::ShowClock& showClock);
    // The moment that the next frame is for: the first refresh that can still be met.
    Time nextDue();
    // One frame on every output; returns when another can be made.
    void step();
    // The show is over: refreshes up to `end` that no frame was made for count as late, and the
    // taps' readers get what is still on its way. After the last frame.
    void finish(Time end);

    // `statuses`, Devices::statuses(), with what the loop knows besides: a display that runs is
    // Faulted where its picture cannot be drawn, or where it keeps the loop from going on, and in
    // trouble where it could not follow its newest settings. Thread-safe; never waits for the
    // render thread.
    std::vector<DeviceStatus> withFaults(std::vector<DeviceStatus> statuses) const;

    // Counters for the progress line. Thread-safe.
    std::int64_t framesShown() const { return framesShown_; }  // on all outputs
    std::int64_t framesShown(std::size_t output) const { return framesShownOn_[output]; }
    std::int64_t framesLate() const { return framesLate_; }
    // After the last frame.
    std::vector<OutputReport> outputs() const;
    const Durations& swapSkew() const { return swapSkew_; }
    const Durations& inputToFrame() const { return inputToFrame_; }

private:
    // An attempt to make an output's renderer while the others are shown.
    struct Making {
        Result<void> made;
        std::atomic<bool> ended = false;  // the context is free again
        std::jthread thread;              // last, so that it ends before the rest goes
    };
    struct Output {
        const show::Output& site;
        DisplaySink& display;
        std::shared_ptr<const render::BlendMap> blend;  // by the site file
        std::unique_ptr<LatestValue<std::shared_ptr<const OutputSettings>>> settings =
            std::make_unique<LatestValue<std::shared_ptr<const OutputSettings>>>();
        std::unique_ptr<render::OutputRenderer> renderer{};  // made when the display's context is first there
        std::unique_ptr<render::FrameTap> tap{};             // where somebody reads
        int context = 0;                                     // the display's, that they are in
        bool fresh = false;                                  // the renderer knows the site file's settings alone
        bool faulted = false;                                // it could not be drawn the last time
        Time retryAt{}, pause{};                             // ... and is tried again then; after how long
        bool bends = false;                                  // the renderer was made for a mesh
        bool running = false;                                // when it was asked last
        bool drawn = false;                                  // in the frame that is being made
        PartTimes spent{};                                   // on that frame so far
        std::optional<Shown> shown{};                        // the newest frame; none since it was lost
        PartTimes spentUntilShown{};                         // spent_ then
        std::unique_ptr<Making> making{};                    // while it is there the display is lent, and so is all else here
        OutputReport report{};
    };
    // In place of the one that is there, which stays where this fails.
    Result<void> makeRenderer(Output& output, const Projection& projection, const std::shared_ptr<const render::BlendMap>& blend);
    Result<void> beReady(Output& output);
    // beReady(), where an exception is an error, too.
    Result<void> attempt(Output& output);
    void makeAside(Output& output);
    // What became of the newest attempt: whether it can be drawn now, or at least once its display
    // is there.
    bool settle(Output& output, const Result<void>& made);
    bool ready(Output& output, Time now);  // settles an attempt where one is due
    // Takes an output back whose attempt has ended. Whether it is here, and not lent.
    bool isHere(Output& output);
    // Does something for one output. An exception is a fault of that output alone: it is taken for
    // one that cannot be drawn, and gets another renderer.
    template <class Work>
    void alone(Output& output, const Work& work);
    void giveUp(Output& output, const char* why);
    // Tells, or takes back (""), why it cannot be drawn, or not follow its settings.
    void tell(std::vector<std::string>& faults, const Output& output, const std::string& fault);
    bool becomesCurrent(Output& output) noexcept;
    void forget(Output& output);
    void inHand(const Output& output);
    void followSettings(Output& output);
    void draw(Output& output, const show::OutputState& state, const Wind& wind, Time showTime);
    void finish(Output& output);
    using Presenting = std::function<Result<Shown>(DisplaySink&)>;
    void show(Output& output, const Presenting& present);
    void giveToReaders(Output& output);
    void measureSkew();
    void measureInputToFrame(Time input, Time seen);  // show time of the one, the other's moment
    void look();
    Output* leader();
    void spend(Output& output, FramePart part, Time time);
    void countLate(Output& output, std::int64_t refreshes);

    render::PictureSources sources_;
    std::filesystem::path assets_;
    Clock& clock_;
    show::ShowClock showClock_;
    Time newest_{};  // the moment that the newest frame is for
    PlaybackReplica replica_;
    show::ShowState state_;
    std::vector<Output> outputs_;
    LatestValue<show::ShowState>* stateSlot_ = nullptr;
    bool makesAside_ = false;
    PartTimes spent_{};  // on all frames of all outputs
    Durations swapSkew_;
    Durations inputToFrame_;
    std::atomic<std::int64_t> framesShown_ = 0, framesLate_ = 0;
    std::vector<std::atomic<std::int64_t>> framesShownOn_;  // each output

    mutable std::mutex faultsMutex_;
    std::vector<std::string> faults_;             // by output; "": none
    std::vector<std::string> unfollowed_;         // settings, by output: why not; "": followed
    std::vector<Time> madeSince_;                 // by output: since when its renderer is made aside; kNever: it is not
    std::atomic<std::size_t> inHand_ = 0;         // the output that the loop works on
    std::atomic<Time::rep> hangsFrom_ = kNotYet;  // on the clock: it hangs in that output unless it has gone on until then
    static constexpr Time::rep kNotYet = Time::max().count();
    static constexpr Time kNever = Time::max();
};

}  // namespace fantascope::app
