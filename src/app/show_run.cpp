#include "app/show_run.h"

#include "app/data_folder.h"
#include "app/edit_keys.h"
#include "app/frame_loop.h"
#include "app/hand.h"
#include "app/lighting.h"
#include "app/part.h"
#include "app/programme.h"
#include "app/recording.h"
#include "app/screenshots.h"
#include "app/setting_up.h"
#include "app/site_models.h"
#include "app/terminal_keys.h"
#include "app/watch.h"
#include "drivers/site/simulated_site.h"

#include "core/bounded_queue.h"
#include "core/check.h"
#include "core/log.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <mutex>
#include <type_traits>
#include <utility>

namespace fantascope::app {
namespace {

constexpr double kSiteRate = 120;                          // Hz; a camera frame is exposed at most a tick late
constexpr double kProgressRate = 2;                        // Hz
constexpr Time kStartUp = std::chrono::milliseconds(100);  // for the parts to be made and their threads to be there

// News for the operator, from the input thread to the progress line.
class News {
public:
    void add(const std::string& sentence) {
        const std::lock_guard lock(mutex_);
        text_ += (text_.empty() ? "" : "; ") + sentence;
    }
    std::string take() {
        const std::lock_guard lock(mutex_);
        return std::exchange(text_, {});
    }

private:
    std::mutex mutex_;
    std::string text_;
};

// The world that a run plays in: the devices, and the simulated site where they are simulated.
struct Surrounding {
    site::World world;
    std::unique_ptr<site::SimulatedSite> simulation;  // null: real devices
    Devices devices;

    static Result<std::unique_ptr<Surrounding>> open(const RunOptions& options, const show::Site& site, Clock& clock) {
        auto surrounding = std::make_unique<Surrounding>(clock);
        const bool simulated = options.backends != Backends::AsDeclared;
        if (simulated) {
            if (!site.simulation)
                return Error(fmt::format("{}: has no 'simulation' section, so it cannot be rehearsed; see docs/site-format.md",
                                         site.file.string()));
            surrounding->simulation =
                TRY(site::SimulatedSite::open(*site.simulation, TRY(simulationOf(site)), options.seed, surrounding->world));
        }
        surrounding->devices = TRY(openDevices(site, options.backends, {clock, simulated ? &surrounding->world : nullptr}));
        return surrounding;
    }
    explicit Surrounding(const Clock& clock) : world(clock) {}
};

// A show while it runs: its parts, and what they pass to each other. Each part is declared in one function below.
class ShowRun {
public:
    ShowRun(const RunOptions& options, const Programme& programme, Surrounding& surrounding, Recording* recording, Clock& clock)
        : options_(options),
          programme_(programme),
          surrounding_(surrounding),
          recording_(recording),
          clock_(clock),
          frames_(programme.site, programme.cues, programme.sources, dataFolder() / "assets", surrounding.devices, clock),
          keys_(options.asFastAsPossible ? nullptr : std::make_unique<TerminalKeys>()),
          wall_(readers(surrounding.simulation != nullptr,
                        [](render::FrameTap& tap) { return &tap.addNewest(std::numeric_limits<double>::infinity()); })),
          recorded_{readers(recording != nullptr, [](render::FrameTap& tap) { return &tap.addQueue(); }), {}},
          pictured_(readers(keys_ && keys_->listens(), [](render::FrameTap& tap) { return &tap.addNewest(0); })),
          prepared_(frames_.prepare()),
          start_(frames_.refreshFrom(clock.now() + kStartUp)),
          lighting_(programme.site, programme.cues, surrounding.devices, clock, start_, recording),
          hand_(programme.show, programme.cues, programme.site, surrounding.devices, start_),
          watch_(programme.show, outputNames(), programme.comparisons, surrounding.devices.camera.get(), programme.camera.get(),
                 start_, recording),
          settingUp_(programme.site, frames_, surrounding.devices, [this](const std::string& sentence) { news_.add(sentence); }),
          schedule_(scheduleOf(options, programme)) {
        frames_.begin(start_);
        frames_.publishStateTo(watch_.shown());
        hand_.feed(frames_.replica());
        hand_.feed(lighting_.replica());
        hand_.edit = [this](show::Button button, bool pressed) { settingUp_.button(button, pressed); };
        hand_.editing = [this] { return settingUp_.on(); };
        lighting_.tell = [this](const std::string& sentence) { news_.add(sentence); };
        hand_.tell = [this](const std::string& sentence) { news_.add(sentence); };
        if (!pictured_.empty()) {
            screenshots_.emplace(options.pictures, programme.show, programme.cues, outputNames(), pictured_, start_);
            hand_.feed(screenshots_->replica());
            screenshots_->tell = hand_.tell;
        }
        if (programme.firstInput) hand_.give(*programme.firstInput);
    }

    std::vector<Part> parts(const std::function<void(const RunStatus&)>& progress) {
        std::vector<Part> parts;
        parts.push_back({"input", Hand::kRate, start_, [this](Time moment) { takeInput(moment); }, Rank::Input});
        parts.push_back({"lighting", Lighting::kRate, start_, [this](Time moment) { lighting_.tick(moment); }, Rank::Lighting});
        for (Part& relays : lighting_.relayParts()) parts.push_back(std::move(relays));
        if (surrounding_.simulation) parts.push_back(simulatedSite());
        parts.push_back({"watch", Watch::kRate, start_, [this](Time moment) { watch_.tick(moment); }, Rank::Watch});
        if (recording_ != nullptr) parts.push_back(recorder());
        if (screenshots_)
            parts.push_back(
                {"pictures", Screenshots::kRate, start_, [this](Time moment) { screenshots_->tick(moment); }, Rank::Watch});
        parts.push_back(
            {"progress", kProgressRate, start_, [this, progress](Time moment) { progress(statusAt(moment)); }, Rank::Input});
        if (!options_.asFastAsPossible) {
            parts.push_back({"setting up", SettingUp::kRate, start_,
                             [this](Time moment) { settingUp_.tick(moment, [this](const Key& key) { screenKeys_.push(key); }); },
                             Rank::Watch});
            parts.push_back(yardstick());
        }
        return parts;
    }

    // The render thread's life.
    Result<void> draw(const Interrupt& interrupt) {
        TRY(std::move(prepared_));
        clock_.sleepUntil(start_);
        const Time end = options_.length ? start_ + *options_.length : Time::max();
        const auto stopped = [&] { return interrupt.requested() || quit_; };
        while (!stopped() && frames_.nextDue() <= end) TRY(frames_.step());
        if (!stopped()) clock_.sleepUntil(end);  // the last frame is seen
        length_ = clock_.now() - start_;
        frames_.finish(stopped() ? clock_.now() : end);
        return {};
    }

    // Once all parts have ended.
    Result<RunReport> report() {
        record(Time::max());  // the last frame's moment came with the end of the parts
        TRY(std::move(recorded_.written).in("recording"));
        if (settingUp_.unsaved())
            log::warning("app",
                         "how the outputs were set up was not written to " + programme_.site.file.string() + " and is lost");
        RunReport report;
        report.length = length_;
        report.stopReason = options_.length && report.length >= *options_.length ? "length" : "interrupted";
        report.seed = options_.seed;
        report.outputs = frames_.outputs();
        report.swapSkew = frames_.swapSkew();
        report.inputToFrame = frames_.inputToFrame();
        report.dmxInterval = lighting_.dmxInterval();
        report.yardstickTicks = yardstickTicks_;
        report.yardstickLate = yardstickLate_;
        report.cues = hand_.cues();
        report.zCamera = watch_.series();
        for (std::size_t i = 0; i < programme_.sources.size(); ++i)
            if (const auto* video = std::get_if<render::VideoSource>(&programme_.sources[i]))
                report.lateVideoFrames[programme_.show.sources[i].name] = video->stream->lateFrames();
        if (surrounding_.simulation)
            for (const site::Happening& happening : surrounding_.simulation->happenings())
                report.faults.push_back({happening.at, happening.text});
        return report;
    }

private:
    static GoSchedule scheduleOf(const RunOptions& options, const Programme& programme) {
        if (!options.handsOff || !options.length) return {0, false, {}};
        const bool cueIsOn = programme.firstInput.has_value();
        const std::size_t entered = cueIsOn ? static_cast<std::size_t>(programme.firstInput->cue) + 1 : 0;
        return {programme.show.cues.size() - entered, cueIsOn, *options.length};
    }
    std::vector<std::string> outputNames() const {
        std::vector<std::string> names;
        for (const show::Output& output : programme_.site.outputs) names.push_back(output.name);
        return names;
    }
    double frameRate() const { return programme_.site.outputs[0].refreshRate; }
    // A reader of each output's frames, where somebody reads.
    template <class Add>
    std::vector<std::invoke_result_t<Add, render::FrameTap&>> readers(bool wanted, const Add& add) {
        std::vector<std::invoke_result_t<Add, render::FrameTap&>> readers;
        for (std::size_t output = 0; wanted && output < programme_.site.outputs.size(); ++output)
            readers.push_back(add(frames_.tap(output)));
        return readers;
    }

    void takeInput(Time moment) {
        while (const auto character = keys_ ? keys_->poll() : std::nullopt)
            if (const auto key = terminal_.take(*character)) pressKey(*key, moment);
        if (const auto key = terminal_.pause(moment)) pressKey(*key, moment);
        while (const auto key = screenKeys_.pop()) pressKey(*key, moment);
        if (schedule_.due(moment - start_)) pressGo(moment);
        hand_.tick(moment);
    }
    // The terminal's keys act as a hand controller; whoever presses one has taken over from the schedule.
    void pressKey(const Key& pressed, Time moment) {
        if (settingUp_.key(pressed)) return;
        const char key = pressed.letter;
        if (key == 'q') quit_ = true;
        if (key == 's' && screenshots_) screenshots_->take();
        for (const auto& [name, kind] :
             {std::pair{' ', show::Input::Kind::Go}, {'b', show::Input::Kind::Back}, {'0', show::Input::Kind::Blackout}}) {
            if (key != name) continue;
            if (!schedule_.ended()) news_.add("you have the controller");
            schedule_.end();
            hand_.give({moment - start_, kind});
        }
    }
    // A press of the simulated hand, through its device; straight to the show where the site has no controller.
    void pressGo(Time moment) {
        const auto& buttons = programme_.site.buttons;
        const auto go =
            std::find_if(buttons.begin(), buttons.end(), [](const auto& button) { return button.second == show::Button::Go; });
        if (surrounding_.simulation && surrounding_.devices.cueController && go != buttons.end())
            for (const bool pressed : {true, false}) surrounding_.world.press(go->first, pressed);
        else
            hand_.give({moment - start_, show::Input::Kind::Go});
    }

    // What the displays show is what the simulated projectors throw, whatever display it is.
    Part simulatedSite() {
        surrounding_.simulation->begin(start_);
        return {"site", kSiteRate, start_,
                [this](Time moment) {
                    for (render::NewestFrame* projector : wall_)
                        if (const render::ShownFrame* frame = projector->next(moment)) {
                            const std::string& output = programme_.site.outputs[frame->output].name;
                            surrounding_.world.setFrame(output, std::make_shared<const RgbaImage>(frame->image));
                        }
                    surrounding_.simulation->advanceTo(moment);
                },
                Rank::Watch};
    }

    Part recorder() {
        // Half a refresh after the frames became visible.
        return {"recording", frameRate(), start_ + tickTime(1, 2 * frameRate()), [this](Time moment) { record(moment); },
                Rank::Watch};
    }
    // What became visible until a moment and was not recorded yet.
    void record(Time moment) {
        for (render::FrameQueue* reader : recorded_.readers)
            while (const render::ShownFrame* frame = reader->next(moment))
                if (recorded_.written)
                    recorded_.written = recording_->frame(frame->output, frame->image, frame->shown.refresh, frame->showTime);
    }

    // What the machine itself misses: a thread of the render thread's rank that does nothing, at the leading output's rate.
    Part yardstick() {
        return {"yardstick", frameRate(), start_,
                [this, last = std::int64_t{-1}](Time moment) mutable {
                    const std::int64_t tick = tickAt(moment - start_, frameRate());
                    yardstickLate_ += tick - last - 1;
                    ++yardstickTicks_;
                    last = tick;
                },
                Rank::Render};
    }

    // Tells of every device that goes, or was not there from the beginning, of what else is wrong with it then, and of every one that comes
    // back.
    void tellOfDevices() {
        const std::vector<DeviceStatus> statuses = surrounding_.devices.statuses();
        missing_.resize(statuses.size());
        for (std::size_t i = 0; i < statuses.size(); ++i) {
            const DeviceStatus& device = statuses[i];
            std::optional<std::string> why;
            if (device.state == DeviceState::Absent || device.state == DeviceState::Faulted) why = device.detail;
            if (why == missing_[i]) continue;
            news_.add(why ? fmt::format("{} ({}) is missing: {}", device.name, device.driver, *why)
                          : fmt::format("{} ({}) is back", device.name, device.driver));
            missing_[i] = std::move(why);
        }
    }

    RunStatus statusAt(Time moment) {
        tellOfDevices();
        RunStatus status;
        status.showTime = moment - start_;
        status.said = news_.take();
        const std::int64_t shown = frames_.framesShown();
        status.framesPerSecond = static_cast<double>(shown - std::exchange(framesBefore_, shown)) * kProgressRate;
        status.lateFrames = frames_.framesLate();
        const auto scores = watch_.newestScores();
        for (std::size_t output = 0; output < scores.size(); ++output)
            status.zCamera.emplace_back(programme_.site.outputs[output].name, scores[output]);
        return status;
    }

    const RunOptions& options_;
    const Programme& programme_;
    Surrounding& surrounding_;
    Recording* recording_;
    Clock& clock_;
    FrameLoop frames_;
    std::unique_ptr<TerminalKeys> keys_;      // null: as fast as possible, there is nobody to press one
    std::vector<render::NewestFrame*> wall_;  // what simulated projectors throw; none where they are real
    struct Recorded {
        std::vector<render::FrameQueue*> readers;  // none where nothing is recorded
        Result<void> written;
    } recorded_;
    std::vector<render::NewestFrame*> pictured_;  // none where no terminal listens
    Result<void> prepared_;
    const Time start_;  // after everything slow; a refresh
    Lighting lighting_;
    Hand hand_;
    Watch watch_;
    SettingUp settingUp_;
    GoSchedule schedule_;
    std::optional<Screenshots> screenshots_;
    TerminalKeyParser terminal_;
    BoundedQueue<Key, 16> screenKeys_;  // pressed at a display, from the part that polls it
    News news_;
    std::atomic<bool> quit_ = false;
    Time length_{};
    std::vector<std::optional<std::string>> missing_;  // and why; of Devices::statuses(), the progress part's
    std::int64_t framesBefore_ = 0, yardstickTicks_ = 0, yardstickLate_ = 0;
};

}  // namespace

Result<RunReport> runShow(const RunOptions& options, const Interrupt& interrupt,
                          const std::function<void(const RunStatus&)>& progress) {
    FANTASCOPE_CHECK(options.length || !options.asFastAsPossible, "as fast as possible needs an end");
    const Programme programme = TRY(readProgramme(options));

    SteadyClock steadyClock;
    SteppedClock steppedClock;
    Clock& clock = options.asFastAsPossible ? static_cast<Clock&>(steppedClock) : steadyClock;
    if (!options.asFastAsPossible) setThreadRank(Rank::Render);  // before the displays make threads of their own
    const auto surrounding = TRY(Surrounding::open(options, programme.site, clock));
    std::unique_ptr<Recording> recording;
    if (!options.recordTo.empty()) {
        std::vector<Recording::Output> outputs;
        for (const show::Output& output : programme.site.outputs)
            outputs.push_back({output.name, output.size(), output.refreshRate});
        recording = TRY(Recording::open(options.recordTo, std::move(outputs)));
    }

    ShowRun run(options, programme, *surrounding, recording.get(), clock);
    Result<void> drawn;
    if (options.asFastAsPossible) {
        steppedClock.setParts(run.parts(progress));
        drawn = run.draw(interrupt);
        steppedClock.setParts({});
    } else {
        const PartThreads threads(clock, run.parts(progress));
        drawn = run.draw(interrupt);
    }
    TRY(std::move(drawn));
    RunReport report = TRY(run.report());
    if (recording) TRY(recording->finish());
    return report;
}

}  // namespace fantascope::app
