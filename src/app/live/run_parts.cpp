#include "app/live/run_parts.h"

#include "app/base/terminal_keys.h"
#include "app/parts/part_guard.h"

#include "show/names.h"

#include "core/log.h"

#include <fmt/format.h>

#include <cstdio>
#include <functional>
#include <limits>

namespace fantascope::app {

namespace {

constexpr double kSiteRate = 120;                          // Hz; a camera frame is exposed at most a tick late
constexpr double kProgressRate = 2;                        // Hz
constexpr Time kStartUp = std::chrono::milliseconds(100);  // for making the parts and starting their threads

}  // namespace

RunParts::RunParts(const RunOptions& options, const Programme& programme, OpenSite& openSite, Recording* recording, Clock& clock,
                   const std::filesystem::path& assets, Supervisor& supervisor, RelayGuard* guard, NightJournal* journal,
                   const WallClock& wall)
    : options_(options),
      programme_(programme),
      openSite_(openSite),
      clock_(clock),
      supervisor_(supervisor),
      wall_(wall),
      faults_(events_),
      played_(programme.revision),
      inputs_(programme.cues),
      journal_(journal, played_, inputs_, events_),
      frames_(programme.site, inputs_, programme.sources, assets, openSite.devices, clock,
              gainsToApply(programme.site, programme.light)),
      terminal_(options.asFastAsPossible ? nullptr : std::make_unique<TerminalKeys>()),
      attended_(terminal_ && terminal_->listens()),
      thrown_(readers(openSite.simulation != nullptr,
                      [](render::FrameTap& tap) { return &tap.addNewest(std::numeric_limits<double>::infinity()); })),
      recorder_(recorderOf(recording)),
      recordingIsOpen_(recording != nullptr),
      watched_(readers(!programme.watched.empty(), [](render::FrameTap& tap) { return ShownLight::framesOf(tap.addNewest(0)); })),
      pictured_(readers(attended_, [](render::FrameTap& tap) { return &tap.addNewest(0); })),
      prepared_(frames_.prepare()),
      showClock_(frames_.refreshFrom(clock.now() + kStartUp), journal_.resume(programme.nights() != nullptr)),
      deviceWatch_(faults_, show::namesOf(programme.site.relayBanks), showClock_.runStart()),
      lighting_(programme.site, inputs_, openSite.devices, clock, showClock_, recording, faults_, events_),
      caller_(played_, inputs_, events_, wall, showClock_),
      hand_(played_, inputs_, programme.site, openSite.devices, showClock_, events_),
      watch_(played_, show::namesOf(programme.site.outputs), programme.comparisons, openSite.devices.camera.get(),
             programme.camera.get(), showClock_, recording),
      settingUp_(programme.site, frames_, openSite.devices, showClock_, events_),
      keys_(inputs_, events_, showClock_, std::move(terminal_), schedule(), QuitKey(options.backends == Backends::AsDeclared),
            keyActions()),
      view_(played_, inputs_, events_, showClock_, options.length),
      reload_(played_, programme.names, programme.files(std::bind_front(&SettingUp::adopt, &settingUp_)), frames_.sources(),
              inputs_, events_, showClock_),
      yardstick_(programme.site.outputs[0].refreshRate, showClock_.runStart()),
      lights_(programme.site, openSite.devices, lighting_, faults_, clock, guard) {
    faults_.begin(showClock_);
    frames_.begin(showClock_);
    if (recorder_) recorder_->begin(showClock_.runStart());
    frames_.publishStateTo(watch_.shown());
    if (!watched_.empty()) {
        watch_.alsoWatch(driftWatch_.emplace(programme.site, programme.watched, cameraLightOf(programme.site), watched_, inputs_,
                                             events_, showClock_),
                         [this] { return settingUp_.moves(); });
        driftWatch_->fitPatterns(programme.patterns, options.asFastAsPossible,
                                 std::bind_front(&SourceStock::makeReady, &frames_.sources()));
    }
    hand_.edit = [this](show::Button button, bool pressed) { settingUp_.button(button, pressed); };
    hand_.editing = [this] { return settingUp_.on(); };
    if (!pictured_.empty())
        screenshots_.emplace(options.pictures, played_, inputs_, show::namesOf(programme.site.outputs), pictured_, showClock_,
                             events_);
    const bool goesOn = journal_.start();
    if (!goesOn && programme.firstInput) inputs_.submit(*programme.firstInput);
    caller_.begin(goesOn ? journal_.endedBefore() : programme.firstInput ? std::optional(wall.now().utc) : std::nullopt);
}

RunParts::~RunParts() {
    supervisor_.release();
    supervisor_.step("closing the devices: look at the X server");
}

Result<void> RunParts::openPage(const std::filesystem::path& files) {
    if (!options_.page) return {};
    const auto health = [this] {
        Report unwell = Report::array();
        for (const FaultReport& fault : faults_.open()) unwell.push_back({{"device", fault.device}, {"what", fault.what}});
        return Report{{"unwell", std::move(unwell)}, {"late", frames_.framesLate()}};
    };
    const Console::Run run{played_, inputs_, events_, showClock_, clock_, health};
    console_ = TRY(Console::open(*options_.page, run, files, [] { setThreadRank(Rank::Watch); }));
    events_.append({showClock_.showTime(showClock_.runStart()), show::event::PageOpened{console_->address()}});
    return {};
}

std::vector<Part> RunParts::lightParts() {
    std::vector<Part> parts;
    const Time start = showClock_.runStart();
    parts.push_back({"input", Hand::kRate, start,
                     [this](Time moment) {
                         keys_.tick(moment);
                         hand_.tick(moment);
                     },
                     Rank::Input});
    parts.push_back({"journal", JournalKeeper::kRate, start, [this](Time moment) { keepJournal(moment); }, Rank::Input});
    parts.push_back({"schedule", ShowCaller::kRate, start, [this](Time moment) { caller_.tick(moment); }, Rank::Input});
    parts.push_back({"lighting", Lighting::kRate, start, [this](Time moment) { lighting_.tick(moment); }, Rank::Lighting});
    for (Part& relays : lighting_.relayParts()) parts.push_back(std::move(relays));
    return guarded(std::move(parts), faults_);
}

std::vector<Part> RunParts::otherParts(const std::function<void(const RunStatus&)>& progress) {
    const Time start = showClock_.runStart();
    std::vector<Part> parts;
    if (openSite_.simulation) parts.push_back(simulatedSite());
    parts.push_back({"watch", Watch::kRate, start, [this](Time moment) { watch_.tick(moment); }, Rank::Watch});
    if (recorder_ && !options_.asFastAsPossible)
        for (Part& video : recorder_->parts()) parts.push_back(std::move(video));
    if (recorder_) parts.push_back(recorder_->tables());
    if (screenshots_)
        parts.push_back(
            {"pictures", Screenshots::kRate, start, [this](Time moment) { screenshots_->tick(moment); }, Rank::Watch});
    const auto watchDevices = [this](Time moment) {
        lights_.whileOpen([&] { deviceWatch_.look(moment, frames_.withFaults(openSite_.devices.statuses())); });
    };
    parts.push_back({"devices", DeviceWatch::kRate, start, watchDevices, Rank::Input});
    parts.push_back(
        {"progress", kProgressRate, start, [this, progress](Time moment) { progress(statusAt(moment)); }, Rank::Input});
    if (console_) parts.push_back({"page", Console::kRate, start, [this](Time moment) { console_->tick(moment); }, Rank::Watch});
    if (!options_.asFastAsPossible) {
        parts.push_back({"files", ShowReload::kRate, start, [this](Time moment) { reload_.tick(moment); }, Rank::Watch});
        parts.push_back({"setting up", SettingUp::kRate, start,
                         [this](Time moment) {
                             settingUp_.tick(moment, [this](const Key& key, Time at) { keys_.pressedAtScreen(key, at); });
                         },
                         Rank::Watch});
        parts.push_back(yardstick_.part());
    }
    return guarded(std::move(parts), faults_);
}

Result<void> RunParts::draw() {
    TRY(std::move(prepared_));
    for (const auto& news : lightNewsOf(programme_.site, programme_.light))
        events_.append({showClock_.showTime(showClock_.runStart()), news});
    if (!options_.asFastAsPossible) frames_.makeRenderersAside();
    clock_.sleepUntil(showClock_.runStart());
    const Time end = options_.length ? showClock_.runStart() + *options_.length : Time::max();
    const auto stopped = [&] { return supervisor_.ending(); };
    PartGuard pictures("pictures", Rank::Lighting, faults_), recording("recording", Rank::Watch, faults_);
    while (!stopped() && frames_.nextDue() <= end) {
        if (!pictures.run(clock_.now(), [this](Time) { frames_.step(); })) clock_.sleepUntil(frames_.nextDue());
        if (recorder_ && options_.asFastAsPossible)
            recording.run(clock_.now(), [this](Time moment) { recorder_->record(moment); });
    }
    if (!stopped()) clock_.sleepUntil(end);  // the last frame is seen until the end
    const bool inTime = !stopped();
    length_ = showClock_.runTime(clock_.now());
    endLights();
    frames_.finish(inTime ? end : clock_.now());
    return {};
}

void RunParts::endLights() {
    lighting_.end(clock_.now());
    supervisor_.requestEnd();
}

Supervisor::Run RunParts::supervised() {
    return {[this] { endLights(); },
            [this] { lighting_.hurry(); },
            [this] { return lighting_.ended(); },
            [this] { closeLights(); },
            [this](const std::string& why) { tellHung(why); },
            [this](const Result<void>& another) { tellGuardDied(another); }};
}

void RunParts::closeLights() {
    lights_.close([this] { keys_.close(); });
}

void RunParts::tellTheRest(const std::function<void(const RunStatus&)>& progress) {
    const Time end = showClock_.runStart() + length_;
    lights_.raiseFaults(end);
    PartGuard guard("progress", Rank::Input, faults_);
    if (view_.hasNews()) guard.run(end, [&](Time moment) { progress(statusAt(moment)); });
}

RunReport RunParts::report() {
    std::vector<OutputReport> outputs = frames_.outputs();
    if (recorder_) recorder_->finish(showClock_.runStart() + length_, outputs);
    recordingIsOpen_ = false;
    if (settingUp_.unsaved())
        log::warning("app", "the outputs' new settings were not written to " + programme_.site.file.string() + " and are lost");
    RunReport report = reportOfLights();
    report.length = length_;
    report.stopReason = options_.length && report.length >= *options_.length ? "length" : "interrupted";
    journal_.end(figuresAt(showClock_.runStart() + length_), report.stopReason);
    report.outputs = std::move(outputs);
    frames_.addTo(report, !options_.asFastAsPossible);
    report.yardstickTicks = yardstick_.ticks();
    report.yardstickLate = yardstick_.late();
    report.zCamera = watch_.series();
    report.toneCamera = watch_.tones();
    report.iouCamera = watch_.ious();
    if (driftWatch_)
        report.causes = driftWatch_->causes(), report.watch = driftWatch_->series(), report.lamps = driftWatch_->lamps();
    addVideos(programme_, report);
    if (openSite_.simulation) addHappenings(openSite_.simulation->happenings(), showClock_, report);
    return report;
}

void RunParts::tellGuardDied(const Result<void>& another) {
    const Time now = clock_.now();
    if (!std::exchange(guardIsAway_, !another))
        faults_.raise(now, "", FaultLog::Topic::Guard,
                      another ? "the relay guard died" : "the relay guard died: " + another.error().message());
    if (another) faults_.clear(now, "", FaultLog::Topic::Guard, "there is a new relay guard");
}

// The figures that are known once the lights are closed, whatever the render thread does.
RunReport RunParts::reportOfLights() const {
    RunReport report;
    report.length = showClock_.runTime(clock_.now());
    report.seed = options_.seed;
    report.frames = frames_.framesShown();
    report.lateFrames = frames_.framesLate();
    report.dmxInterval = lighting_.dmxInterval();
    addEvents(events_, report);
    report.faults = faults_.faults();
    report.unsafe = lights_.unsafe();
    return report;
}

void RunParts::tellHung(const std::string& why) {
    const Time now = clock_.now();
    lights_.raiseFaults(now);
    const bool isLost = recordingIsOpen_;
    if (isLost) faults_.raise(now, "", FaultLog::Topic::Recording, "recording: it was not finished and is lost");
    std::string words = hungSentence(why, unsafe(), lights_.unended(), isLost);
    RunReport report = reportOfLights();
    report.stopReason = "hung";
    report.hung = why;
    for (std::size_t output = 0; isLost && output < programme_.site.outputs.size(); ++output)
        report.lostFrames[programme_.site.outputs[output].name] = frames_.framesShown(output);
    const auto written = options_.report.empty() ? Result<void>() : writeReport(options_.report, jsonOf(report));
    if (!written) words += fmt::format(". No report: {}", written.error().message());
    std::fputs(("\nfantascope: error: " + words + "\n").c_str(), stderr);
}

GoSchedule RunParts::schedule() const {
    if (!options_.handsOff || !options_.length) return {0, false, {}};
    const auto cueOn = journal_.cueOn();
    return goScheduleOf(programme_, cueOn ? cueOn : programme_.firstCue(), *options_.length);
}

void RunParts::keepJournal(Time moment) {
    journal_.tick(figuresAt(moment));
    faults_.tell(moment, "", FaultLog::Topic::Journal, journal_.trouble(), "the journal is written again");
}

std::unique_ptr<FrameRecorder> RunParts::recorderOf(Recording* recording) {
    if (recording == nullptr) return nullptr;
    // At the end, writing the rest of the recording may take longer than a step's timeout.
    return std::make_unique<FrameRecorder>(*recording, programme_.site, frames_, clock_, faults_,
                                           [this] { supervisor_.advance(); });
}

OperatorKeys::Actions RunParts::keyActions() {
    return {[this](const Key& key) { return settingUp_.key(key); },
            [this] { return openSite_.pressGo(programme_.site); },
            [this] { screenshots_ ? screenshots_->take() : void(); },
            [this] { endLights(); },
            [this] { return caller_.nextDay(); },
            [this](const show::ShowState& now) { return howItIs(now, played_.at(now.revision), faults_.open()); },
            show::namesOf(programme_.site.relays)};
}

// The simulated projectors throw what the displays show, whatever the displays' drivers are.
Part RunParts::simulatedSite() {
    openSite_.simulation->begin(showClock_.runStart());
    return {"site", kSiteRate, showClock_.runStart(),
            [this](Time moment) {
                for (render::NewestFrame* projector : thrown_)
                    if (const render::ShownFrame* frame = projector->next(moment)) {
                        const std::string& output = programme_.site.outputs[frame->output].name;
                        openSite_.world.setFrame(output, std::make_shared<const RgbaImage>(frame->image));
                    }
                openSite_.simulation->advanceTo(moment);
            },
            Rank::Watch};
}

RunStatus RunParts::statusAt(Time moment) {
    RunStatus status = view_.at(moment, keys_.nextGo(), keys_.list());
    status.settingUp = settingUp_.on();
    status.keys = attended_;
    status.unwell = namesOf(faults_.open());
    status.schedule = outlook_.at(wall_.now().utc);
    const std::int64_t shown = frames_.framesShown(), before = std::exchange(framesBefore_, shown);
    if (showClock_.runTime(moment) > Time{}) status.framesPerSecond = static_cast<double>(shown - before) * kProgressRate;
    status.lateFrames = frames_.framesLate();
    status.zCamera = watch_.newestScores();
    return status;
}

show::journal::Figures RunParts::figuresAt(Time moment) const {
    return {showClock_.showTime(moment), frames_.framesShown(), frames_.framesLate(), watch_.newestScores()};
}

}  // namespace fantascope::app
