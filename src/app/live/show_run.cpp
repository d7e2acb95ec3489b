#include "app/live/show_run.h"

#include "app/base/data_folder.h"
#include "app/base/terminal_keys.h"
#include "app/live/edit_keys.h"
#include "app/live/fault_log.h"
#include "app/live/frame_loop.h"
#include "app/live/frame_recorder.h"
#include "app/live/hand.h"
#include "app/live/lighting.h"
#include "app/live/part.h"
#include "app/live/part_guard.h"
#include "app/live/programme.h"
#include "app/live/recording.h"
#include "app/live/run_keys.h"
#include "app/live/screenshots.h"
#include "app/live/setting_up.h"
#include "app/live/supervisor.h"
#include "app/live/watch.h"
#include "app/site/relay_guard.h"
#include "app/site/site_claims.h"
#include "app/site/site_models.h"
#include "drivers/site/simulated_site.h"

#include "core/append_log.h"
#include "core/check.h"
#include "core/config.h"
#include "core/log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <mutex>
#include <type_traits>
#include <utility>

namespace fantascope::app {
namespace {

constexpr double kSiteRate = 120;                          // Hz; a camera frame is exposed at most a tick late
constexpr double kProgressRate = 2;                        // Hz
constexpr Time kLookAgain = std::chrono::milliseconds(5);  // at the lights, whether they are there
constexpr Time kStartUp = std::chrono::milliseconds(100);  // for the parts to be made and their threads to be there

// News for the operator, from the input thread to the progress line.
class News {
public:
    void add(const std::string& sentence) {
        const std::lock_guard lock(mutex_);
        text_ += (text_.empty() ? "" : "; ") + sentence;
    }
    bool isThere() {
        const std::lock_guard lock(mutex_);
        return !text_.empty();
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

// A show while it runs: its parts, and what they pass to each other. Each part is declared in one
// function below.
class ShowRun {
public:
    // All outlive it; `recording` and `guard` may be null.
    ShowRun(const RunOptions& options, const Programme& programme, Surrounding& surrounding, Recording* recording, Clock& clock,
            const std::filesystem::path& assets, Supervisor& supervisor, RelayGuard* guard, News& news)
        : options_(options),
          programme_(programme),
          surrounding_(surrounding),
          clock_(clock),
          supervisor_(supervisor),
          guard_(guard),
          news_(news),
          faults_([this](const std::string& sentence) { news_.add(sentence); }),
          inputs_(programme.cues),
          frames_(programme.site, inputs_, programme.sources, assets, surrounding.devices, clock),
          keys_(options.asFastAsPossible ? nullptr : std::make_unique<TerminalKeys>()),
          wall_(readers(surrounding.simulation != nullptr,
                        [](render::FrameTap& tap) { return &tap.addNewest(std::numeric_limits<double>::infinity()); })),
          recorder_(recorderOf(recording)),
          recordingIsOpen_(recording != nullptr),
          pictured_(readers(keys_ && keys_->listens(), [](render::FrameTap& tap) { return &tap.addNewest(0); })),
          prepared_(frames_.prepare()),
          start_(frames_.refreshFrom(clock.now() + kStartUp)),
          deviceWatch_(faults_, bankNames()),
          lighting_(programme.site, inputs_, surrounding.devices, clock, start_, recording, &faults_),
          hand_(programme.show, inputs_, programme.site, surrounding.devices, start_),
          watch_(programme.show, outputNames(), programme.comparisons, surrounding.devices.camera.get(), programme.camera.get(),
                 start_, recording),
          settingUp_(programme.site, frames_, surrounding.devices, [this](const std::string& sentence) { news_.add(sentence); }),
          schedule_(scheduleOf(options, programme)),
          quitKey_(options.backends == Backends::AsDeclared),
          told_(inputs_) {
        frames_.begin(start_);
        if (!options.asFastAsPossible) frames_.makeRenderersAside();
        if (recorder_) recorder_->begin(start_);
        frames_.publishStateTo(watch_.shown());
        hand_.edit = [this](show::Button button, bool pressed) { settingUp_.button(button, pressed); };
        hand_.editing = [this] { return settingUp_.on(); };
        lighting_.tell = [this](const std::string& sentence) { news_.add(sentence); };
        hand_.tell = [this](const std::string& sentence) { news_.add(sentence); };
        if (!pictured_.empty()) {
            screenshots_.emplace(options.pictures, programme.show, inputs_, outputNames(), pictured_, start_);
            screenshots_->tell = hand_.tell;
        }
        if (programme.firstInput) inputs_.submit(*programme.firstInput);
    }

    ~ShowRun() {
        supervisor_.release();
        supervisor_.step("closing the devices: look at the X server");
    }

    // What goes on until lamps and relays are closed: nothing that waits for a display, a file or a
    // terminal.
    std::vector<Part> lightParts() {
        std::vector<Part> parts;
        parts.push_back({"input", Hand::kRate, start_, [this](Time moment) { takeInput(moment); }, Rank::Input});
        parts.push_back({"lighting", Lighting::kRate, start_, [this](Time moment) { lighting_.tick(moment); }, Rank::Lighting});
        for (Part& relays : lighting_.relayParts()) parts.push_back(std::move(relays));
        return guardedParts(std::move(parts));
    }
    std::vector<Part> otherParts(const std::function<void(const RunStatus&)>& progress) {
        std::vector<Part> parts;
        if (surrounding_.simulation) parts.push_back(simulatedSite());
        parts.push_back({"watch", Watch::kRate, start_, [this](Time moment) { watch_.tick(moment); }, Rank::Watch});
        if (recorder_ && !options_.asFastAsPossible)
            for (Part& video : recorder_->parts()) parts.push_back(std::move(video));
        if (recorder_) parts.push_back(recorder_->tables());
        if (screenshots_)
            parts.push_back(
                {"pictures", Screenshots::kRate, start_, [this](Time moment) { screenshots_->tick(moment); }, Rank::Watch});
        parts.push_back({"devices", DeviceWatch::kRate, start_, [this](Time moment) { watchDevices(moment); }, Rank::Input});
        parts.push_back(
            {"progress", kProgressRate, start_, [this, progress](Time moment) { progress(statusAt(moment)); }, Rank::Input});
        if (!options_.asFastAsPossible) {
            parts.push_back(
                {"setting up", SettingUp::kRate, start_,
                 [this](Time moment) { settingUp_.tick(moment, [this](const Key& key) { screenKeys_.append(key); }); },
                 Rank::Watch});
            parts.push_back(yardstick());
        }
        return guardedParts(std::move(parts));
    }

    // The lights' parts, on threads that end with closeLights(); the stepped clock has them
    // otherwise.
    void startLights() { lights_.emplace(clock_, lightParts()); }

    // The render thread's life. The end has begun when it returns.
    Result<void> draw() {
        TRY(std::move(prepared_));
        clock_.sleepUntil(start_);
        const Time end = options_.length ? start_ + *options_.length : Time::max();
        const auto stopped = [&] { return supervisor_.ending(); };
        PartGuard pictures("pictures", Rank::Lighting, faults_, showTimeOf()),
            recording("recording", Rank::Watch, faults_, showTimeOf());
        while (!stopped() && frames_.nextDue() <= end) {
            if (!pictures.run(clock_.now(), [this](Time) { frames_.step(); })) clock_.sleepUntil(frames_.nextDue());
            if (recorder_ && options_.asFastAsPossible)
                recording.run(clock_.now(), [this](Time moment) { recorder_->record(moment); });
        }
        if (!stopped()) clock_.sleepUntil(end);  // the last frame is seen
        const bool inTime = !stopped();
        length_ = clock_.now() - start_;
        endLights();
        frames_.finish(inTime ? end : clock_.now());
        return {};
    }

    // Relays to their safe states, lamps to their end levels, from now on. Never waits. Thread:
    // any.
    void endLights() {
        lighting_.end(clock_.now());
        supervisor_.requestEnd();
    }
    // What the supervisor needs to end it while the render thread hangs.
    Supervisor::Run supervised() {
        return {[this] { endLights(); },
                [this] { lighting_.hurry(); },
                [this] { return lighting_.ended(); },
                [this] { closeLights(); },
                [this](const std::string& why) { tellHung(why); },
                [this](const Result<void>& another) { tellGuardDied(another); }};
    }
    // Waits until lamps and relays are where they are to be at the end, for as long as that may
    // take.
    void awaitLights() {
        const Time latest = clock_.now() + programme_.site.endFade + Supervisor::kSafeWithin;
        while (!lighting_.ended() && clock_.now() < latest) clock_.sleepUntil(clock_.now() + kLookAgain);
    }
    // Ends what works on lamps and relays and closes both. Where all relays are safe the guard may
    // go. Thread: any.
    void closeLights() {
        const std::lock_guard lock(closing_);
        if (std::exchange(closed_, true)) return;
        lights_.reset();
        keys_.reset();  // the terminal is as it was
        unsafe_ = lighting_.unsafeBanks();
        unended_ = lighting_.unendedLines();
        surrounding_.devices.lines.clear();
        surrounding_.devices.relayBanks.clear();
        if (guard_ != nullptr && unsafe_.empty()) guard_->dismiss();
    }
    // Tells which relays are not safe and which lamps not at their end levels, and whatever else
    // nobody was told yet. Once the lights are closed.
    void tellTheRest(const std::function<void(const RunStatus&)>& progress) {
        raiseLastFaults(length_);
        PartGuard guard("progress", Rank::Input, faults_, showTimeOf());
        if (news_.isThere()) guard.run(start_ + length_, [&](Time moment) { progress(statusAt(moment)); });
    }

    // Once all parts have ended.
    RunReport report() {
        std::vector<OutputReport> outputs = frames_.outputs();
        if (recorder_) recorder_->finish(length_, outputs);
        recordingIsOpen_ = false;
        if (settingUp_.unsaved())
            log::warning("app",
                         "how the outputs were set up was not written to " + programme_.site.file.string() + " and is lost");
        RunReport report = reportOfLights();
        report.length = length_;
        report.stopReason = options_.length && report.length >= *options_.length ? "length" : "interrupted";
        report.outputs = std::move(outputs);
        report.swapSkew = frames_.swapSkew();
        report.inputToFrame = frames_.inputToFrame();
        report.yardstickTicks = yardstickTicks_;
        report.yardstickLate = yardstickLate_;
        report.zCamera = watch_.series();
        for (const show::Source& source : programme_.show.sources)
            if (const auto* video = std::get_if<render::VideoSource>(&programme_.sources.find(source.id)->picture)) {
                const std::string& name = source.name;
                report.lateVideoFrames[name] = video->stream->lateFrames();
                report.damagedVideoFrames[name] = video->stream->damagedFrames();
            }
        if (surrounding_.simulation)
            for (const site::Happening& happening : surrounding_.simulation->happenings())
                report.faults.push_back({happening.at, happening.text});
        std::ranges::stable_sort(report.faults, {}, &FaultReport::at);
        return report;
    }

    const std::vector<UnsafeBank>& unsafe() const { return unsafe_; }  // once the lights are closed

private:
    PartGuard::ShowTimeOf showTimeOf() const {
        return [this](Time moment) { return moment - start_; };
    }
    std::vector<Part> guardedParts(std::vector<Part> parts) {
        for (Part& part : parts) part = guarded(std::move(part), faults_, showTimeOf());
        return parts;
    }
    void raiseLastFaults(Time at) {
        for (const auto& [bank, why] : unsafe_) {
            std::vector<std::string> relays;
            for (const show::Relay& relay : programme_.site.relays)
                if (programme_.site.relayBanks[relay.bank].name == bank)
                    relays.push_back(relay.name + (relay.safe ? " on" : " off"));
            faults_.raise(
                at, bank, FaultLog::Topic::SafeStates,
                fmt::format("'{}' has not confirmed its safe states: {}. Look yourself: {}", bank, why, listed(relays)));
        }
        for (const UnendedLine& line : unended_)
            faults_.raise(at, fmt::format("universe {}", line.universe), FaultLog::Topic::EndLevels, sentenceOf(line));
    }
    void tellGuardDied(const Result<void>& another) {
        const Time at = clock_.now() - start_;
        if (!std::exchange(guardIsAway_, !another))
            faults_.raise(at, "", FaultLog::Topic::Guard,
                          another ? "the relay guard died" : "the relay guard died: " + another.error().message());
        if (another) faults_.clear(at, "", FaultLog::Topic::Guard, "there is a new relay guard");
    }
    // What is known once the lights are closed, whatever the render thread does.
    RunReport reportOfLights() const {
        RunReport report;
        report.length = clock_.now() - start_;
        report.seed = options_.seed;
        report.frames = frames_.framesShown();
        report.lateFrames = frames_.framesLate();
        report.dmxInterval = lighting_.dmxInterval();
        report.cues = hand_.cues();
        report.faults = faults_.faults();
        report.unsafe = unsafe_;
        return report;
    }
    void tellHung(const std::string& why) {
        const Time at = clock_.now() - start_;
        raiseLastFaults(at);
        std::string words = fmt::format("the show was to end, but {}. Its lamps and relays were closed first: {}", why,
                                        unsafe_.empty() ? "all relays are safe" : sentenceOf(unsafe_));
        for (const UnendedLine& line : unended_) words += "; " + sentenceOf(line);
        const bool isLost = recordingIsOpen_;
        if (isLost) {
            faults_.raise(at, "", FaultLog::Topic::Recording, "recording: it was not finished and is lost");
            words += ". The recording was not finished and is lost";
        }
        RunReport report = reportOfLights();
        report.stopReason = "hung";
        report.hung = why;
        for (std::size_t output = 0; isLost && output < programme_.site.outputs.size(); ++output)
            report.lostFrames[programme_.site.outputs[output].name] = frames_.framesShown(output);
        if (!options_.report.empty())
            if (const auto written = writeReport(options_.report, jsonOf(report)); !written)
                words += fmt::format(". No report: {}", written.error().message());
        std::fputs(("\nfantascope: error: " + words + "\n").c_str(), stderr);
    }
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
    std::vector<std::string> bankNames() const {
        std::vector<std::string> names;
        for (const show::Bank& bank : programme_.site.relayBanks) names.push_back(bank.name);
        return names;
    }
    double frameRate() const { return programme_.site.outputs[0].refreshRate; }
    std::unique_ptr<FrameRecorder> recorderOf(Recording* recording) {
        if (recording == nullptr) return nullptr;
        // What is not written yet at the end may take longer than a step's patience.
        return std::make_unique<FrameRecorder>(*recording, programme_.site, frames_, clock_, faults_,
                                               [this] { supervisor_.advance(); });
    }
    // A reader of each output's frames, where somebody reads.
    template <class Add>
    std::vector<std::invoke_result_t<Add, render::FrameTap&>> readers(bool wanted, const Add& add) {
        std::vector<std::invoke_result_t<Add, render::FrameTap&>> readers;
        for (std::size_t output = 0; wanted && output < programme_.site.outputs.size(); ++output)
            readers.push_back(add(frames_.tap(output)));
        return readers;
    }

    using Source = show::Input::Source;
    void takeInput(Time moment) {
        while (const auto character = keys_ ? keys_->poll() : std::nullopt)
            if (const auto key = terminal_.take(*character)) pressKey(*key, Source::Terminal, moment);
        if (const auto key = terminal_.pause(moment)) pressKey(*key, Source::Terminal, moment);
        while (const Key* const key = pressedAtScreens_.next()) pressKey(*key, Source::Screen, moment);
        if (schedule_.due(moment - start_)) pressGo(moment);
        nextGo_ = schedule_.next();
        hand_.tick(moment);
    }
    // The terminal's keys act as a hand controller; whoever presses one has taken over from the
    // schedule.
    void pressKey(const Key& pressed, Source source, Time moment) {
        if (settingUp_.key(pressed)) return;
        const auto action = actionOf(pressed.letter);
        if (!action) return;
        switch (*action) {
            case RunKey::Action::Go:
                return takeOver({.at = moment - start_, .kind = show::Input::Kind::Go, .source = source});
            case RunKey::Action::Back:
                return takeOver({.at = moment - start_, .kind = show::Input::Kind::Back, .source = source});
            case RunKey::Action::Blackout:
                return takeOver({.at = moment - start_, .kind = show::Input::Kind::Blackout, .source = source});
            case RunKey::Action::Pictures:
                if (screenshots_) screenshots_->take();
                return;
            case RunKey::Action::Quit:
                if (quitKey_.press(moment))
                    endLights();
                else
                    news_.add(fmt::format("the show goes on; {} again within {:.0f} s ends it", keyFor(*action),
                                          seconds(QuitKey::kPatience)));
                return;
            case RunKey::Action::SetUp:
                return;  // taken by settingUp_
        }
    }
    void takeOver(const show::Input& input) {
        if (!schedule_.ended()) news_.add("you have the controller");
        schedule_.end();
        inputs_.submit(input);
    }
    // A press of the simulated hand, through its device; straight to the show where the site has no
    // controller.
    void pressGo(Time moment) {
        const auto& buttons = programme_.site.buttons;
        const auto go =
            std::find_if(buttons.begin(), buttons.end(), [](const auto& button) { return button.second == show::Button::Go; });
        if (surrounding_.simulation && surrounding_.devices.cueController && go != buttons.end())
            for (const bool pressed : {true, false}) surrounding_.world.press(go->first, pressed);
        else
            inputs_.submit({.at = moment - start_, .kind = show::Input::Kind::Go, .source = Source::Schedule});
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

    // What the machine itself misses: a thread of the render thread's rank that does nothing, at
    // the leading output's rate.
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

    void watchDevices(Time moment) {
        const std::lock_guard lock(closing_);
        if (!closed_) deviceWatch_.look(moment - start_, frames_.withFaults(surrounding_.devices.statuses()));
    }

    // What is on, what comes, and when.
    void tellOfCues(RunStatus& status) {
        const Time time = status.showTime;
        told_.stateAt(time, toldState_);
        const auto& cues = programme_.show.cues;
        const auto next = static_cast<std::size_t>(toldState_.cue + 1);
        status.cue = toldState_.cue;
        status.cues = static_cast<int>(cues.size());
        if (next > 0) status.cueName = cues[next - 1].name;
        if (next < cues.size()) status.nextName = cues[next].name;
        status.fadeLeft = told_.playback().fadeLeftAt(time);
        status.untilNext = told_.playback().untilFollowAt(time);
        if (const Time go = nextGo_; go != Time::max())
            status.untilNext = std::min(status.untilNext.value_or(Time::max()), std::max(Time{}, go - time));
        if (options_.length) status.left = std::max(Time{}, *options_.length - time);
        status.blackout = toldState_.blackout;
        status.settingUp = settingUp_.on();
        status.keys = keys_ && keys_->listens();
    }

    RunStatus statusAt(Time moment) {
        RunStatus status;
        status.showTime = moment - start_;
        tellOfCues(status);
        status.said = news_.take();
        const std::int64_t shown = frames_.framesShown();
        const std::int64_t before = std::exchange(framesBefore_, shown);
        if (status.showTime > Time{}) status.framesPerSecond = static_cast<double>(shown - before) * kProgressRate;
        status.lateFrames = frames_.framesLate();
        const auto scores = watch_.newestScores();
        for (std::size_t output = 0; output < scores.size(); ++output)
            status.zCamera.emplace_back(programme_.site.outputs[output].name, scores[output]);
        return status;
    }

    const RunOptions& options_;
    const Programme& programme_;
    Surrounding& surrounding_;
    Clock& clock_;
    Supervisor& supervisor_;
    RelayGuard* guard_;
    News& news_;
    FaultLog faults_;
    show::InputLog inputs_;
    FrameLoop frames_;
    std::unique_ptr<TerminalKeys> keys_;          // null: as fast as possible, there is nobody to press one
    std::vector<render::NewestFrame*> wall_;      // what simulated projectors throw; none where they are real
    std::unique_ptr<FrameRecorder> recorder_;     // null: nothing is recorded
    std::atomic<bool> recordingIsOpen_;           // its files are not there yet
    std::vector<render::NewestFrame*> pictured_;  // none where no terminal listens
    Result<void> prepared_;
    const Time start_;         // after everything slow; a refresh
    DeviceWatch deviceWatch_;  // the devices part's
    Lighting lighting_;
    Hand hand_;
    Watch watch_;
    SettingUp settingUp_;
    GoSchedule schedule_;
    QuitKey quitKey_;
    std::atomic<Time> nextGo_ = Time::max();  // show time of the schedule's next press
    PlaybackReplica told_;                    // the progress part's
    show::ShowState toldState_;
    std::optional<Screenshots> screenshots_;
    TerminalKeyParser terminal_;
    AppendLog<Key> screenKeys_;  // pressed at a display, from the part that polls it
    AppendLog<Key>::Reader pressedAtScreens_ = screenKeys_.reader();
    Time length_{};
    std::mutex closing_;  // of:
    bool closed_ = false;
    std::vector<UnsafeBank> unsafe_;
    std::vector<UnendedLine> unended_;
    bool guardIsAway_ = false;  // the supervisor's
    std::int64_t framesBefore_ = 0, yardstickTicks_ = 0, yardstickLate_ = 0;
    std::optional<PartThreads> lights_;  // last, so that none works on what has gone
};

// A guard where relays are real.
Result<std::unique_ptr<RelayGuard>> guardOf(const RunOptions& options, const show::Site& site, const SiteClaims& claims) {
    if (options.backends != Backends::AsDeclared || site.relayBanks.empty()) return std::unique_ptr<RelayGuard>();
    return RelayGuard::start(site, claims.files());
}

}  // namespace

Result<RunReport> runShow(const RunOptions& options, const Interrupt& interrupt,
                          const std::function<void(const RunStatus&)>& progress) {
    FANTASCOPE_CHECK(options.length || !options.asFastAsPossible, "as fast as possible needs an end");
    const Programme programme = TRY(readProgramme(options));
    const std::filesystem::path assets = TRY(dataFolder()) / "assets";

    SteadyClock steadyClock;
    SteppedClock steppedClock;
    Clock& clock = options.asFastAsPossible ? static_cast<Clock&>(steppedClock) : steadyClock;
    SiteClaims claims;  // what is simulated takes nothing from anybody
    if (options.backends == Backends::AsDeclared) claims = TRY(SiteClaims::take(programme.site, interrupt));
    const std::unique_ptr<RelayGuard> guard = TRY(guardOf(options, programme.site, claims));
    News news;
    Supervisor supervisor(interrupt, guard.get());
    supervisor.step("opening the devices: look at the X server");
    if (!options.asFastAsPossible) setThreadRank(Rank::Render);  // before the displays make threads of their own
    const auto surrounding = TRY(Surrounding::open(options, programme.site, clock));
    std::unique_ptr<Recording> recording;
    if (!options.recordTo.empty()) {
        std::vector<Recording::Output> outputs;
        for (const show::Output& output : programme.site.outputs)
            outputs.push_back({output.name, output.size(), output.refreshRate});
        recording = TRY(Recording::open(options.recordTo, std::move(outputs)));
    }

    supervisor.step("preparing the pictures: look at the graphics card");
    ShowRun run(options, programme, *surrounding, recording.get(), clock, assets, supervisor, guard.get(), news);
    if (guard) guard->arm();
    supervisor.attend(run.supervised());
    supervisor.step("showing the pictures: look at the X server and the graphics card");
    Result<void> drawn;
    if (options.asFastAsPossible) {
        auto parts = run.lightParts();
        for (Part& part : run.otherParts(progress)) parts.push_back(std::move(part));
        steppedClock.setParts(std::move(parts));
        drawn = run.draw();
        steppedClock.endAllBut(Rank::Lighting);
    } else {
        run.startLights();
        const PartThreads others(clock, run.otherParts(progress));
        drawn = run.draw();
        supervisor.step("ending the show's parts");
    }
    run.endLights();
    supervisor.step("making the relays safe", Supervisor::kSafeWithin + programme.site.endFade + 2 * Supervisor::kPatience);
    run.awaitLights();
    steppedClock.setParts({});
    run.closeLights();
    run.tellTheRest(progress);
    auto reported = [&]() -> Result<RunReport> {
        TRY(std::move(drawn));
        supervisor.step("finishing the recording", 3 * Supervisor::kPatience);
        RunReport report = run.report();
        run.tellTheRest(progress);
        supervisor.step("writing the report");
        if (!options.report.empty()) TRY(writeReport(options.report, jsonOf(report)));
        return report;
    }();
    if (!reported && !run.unsafe().empty()) return Error(reported.error().message() + "; " + sentenceOf(run.unsafe()));
    return reported;
}

}  // namespace fantascope::app
