#include "app/show_run.h"

#include "app/data_folder.h"
#include "app/frame_loop.h"
#include "app/hand.h"
#include "app/lighting.h"
#include "app/part.h"
#include "app/recording.h"
#include "app/site_models.h"
#include "app/terminal_keys.h"
#include "app/watch.h"
#include "drivers/site/simulated_site.h"
#include "show/show.h"

#include "core/log.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>

namespace fantascope::app {

namespace fs = std::filesystem;

namespace {

// The niceness of a real-time run's threads: what the audience sees first, what only looks at it last.
constexpr int kRenderNiceness = -10, kLightingNiceness = -5, kInputNiceness = 0, kWatchNiceness = 10;

constexpr double kProgressRate = 2;  // Hz
// How often the simulated site looks for something to do; a camera frame is exposed at most this much late.
constexpr double kSiteRate = 120;
constexpr double kRelayRate = 20;  // a relay answers in tens of milliseconds

// The show's sources, loaded: what the renderer draws, and what the camera's picture is compared with.
struct LoadedSources {
    std::vector<render::PictureSource> sources;
    std::vector<std::optional<GreyImage>> guides;   // one for each source; none for those that are not drawn after one
    std::vector<double> canvasAspects;
};

Result<LoadedSources> load(const show::Show& show) {
    LoadedSources loaded;
    for (const show::Source& source : show.sources) {
        if (const auto* solid = std::get_if<show::SolidSource>(&source.picture)) {
            loaded.sources.emplace_back(render::SolidSource{solid->colour});
            loaded.guides.emplace_back();
            loaded.canvasAspects.push_back(1);
            continue;
        }
        const fs::path& file = std::get<show::PatternSource>(source.picture).file;
        auto pattern = std::make_shared<const pattern::ShapePattern>(TRY(pattern::readPattern(file)));
        loaded.guides.emplace_back(TRY(readGrey(pattern->guide).in(file.string() + ": its guide")));
        loaded.canvasAspects.push_back(pattern->aspect());
        loaded.sources.emplace_back(render::PatternSource{pattern, std::make_shared<const pattern::PatternMotion>(*pattern)});
    }
    return loaded;
}

Result<std::vector<Watch::Comparisons>> comparisonsOf(const show::Site& site, const LoadedSources& loaded) {
    std::vector<Watch::Comparisons> comparisons(site.outputs.size());
    for (std::size_t output = 0; output < site.outputs.size(); ++output)
        for (std::size_t source = 0; source < loaded.sources.size(); ++source) {
            std::unique_ptr<vision::GuideComparison> comparison;
            const auto view = TRY(nominalViewOf(site, output, loaded.canvasAspects[source]));
            if (view && loaded.guides[source]) comparison = std::make_unique<vision::GuideComparison>(*view, *loaded.guides[source]);
            comparisons[output].push_back(std::move(comparison));
        }
    return comparisons;
}

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

}  // namespace

Result<RunReport> runShow(const RunOptions& options, const Interrupt& interrupt, const std::function<void(const RunStatus&)>& progress) {
    FANTASCOPE_CHECK(options.length || !options.asFastAsPossible, "as fast as possible needs an end");

    // Everything is read before anything lights up.
    const show::Show show = TRY(show::Show::load(options.show));
    const show::Site site = TRY(show::readSite(fs::is_directory(options.site) ? options.site / "site.yaml" : options.site));
    const show::CueList cues = TRY(show.bind(site));
    std::optional<show::Input> firstInput;
    if (!options.fromCue.empty())
        firstInput = show::Input{Time{}, show::Input::Kind::Jump, static_cast<int>(TRY(show.cueNamed(options.fromCue)))};
    LoadedSources loaded = TRY(load(show));
    auto comparisons = TRY(comparisonsOf(site, loaded));

    // The world: a clock, the devices, and the simulated site where these are simulated.
    SteadyClock steadyClock;
    SteppedClock steppedClock;
    Clock& clock = options.asFastAsPossible ? static_cast<Clock&>(steppedClock) : steadyClock;
    const bool simulated = options.backends != Backends::AsDeclared;
    if (!options.asFastAsPossible) setThreadNiceness(kRenderNiceness);  // before the displays make threads of their own
    site::World world(clock);
    std::unique_ptr<site::SimulatedSite> simulatedSite;
    if (simulated) {
        if (!site.simulation)
            return Error(fmt::format("{}: has no 'simulation' section, so it cannot be rehearsed; see docs/site-format.md", site.file.string()));
        simulatedSite = TRY(site::SimulatedSite::open(*site.simulation, TRY(simulationOf(site)), options.seed, world));
    }
    Devices devices = TRY(openDevices(site, options.backends, {clock, simulated ? &world : nullptr}));
    std::unique_ptr<Recording> recording;
    if (!options.recordTo.empty()) {
        std::vector<Recording::Output> outputs;
        for (const show::Output& output : site.outputs) outputs.push_back({output.name, output.size, output.refreshRate});
        recording = TRY(Recording::open(options.recordTo, std::move(outputs)));
    }

    // The parts of the show.
    const Time start = clock.now();
    FrameLoop frames(site, cues, std::move(loaded.sources), dataFolder() / "assets", devices, clock, start);
    Lighting lighting(site, cues, devices, clock, start, recording.get());
    std::vector<std::string> outputNames;
    for (const show::Output& output : site.outputs) outputNames.push_back(output.name);
    Watch watch(show, outputNames, std::move(comparisons), devices.camera.get(), start, recording.get());
    frames.publishStateTo(watch.shown());
    Hand hand(show, cues, site, devices.cueController.get(), start);
    hand.feed(frames.replica());
    hand.feed(lighting.replica());
    News news;
    hand.tell = [&](const std::string& sentence) { news.add(sentence); };
    if (firstInput) hand.give(*firstInput);

    std::vector<Part> parts;
    std::atomic<bool> quit = false;
    std::optional<TerminalKeys> keys;
    if (!options.asFastAsPossible) keys.emplace();
    GoSchedule schedule(options.handsOff && options.length ? show.cues.size() : 0, options.length.value_or(Time{}));
    const auto goButton = std::find_if(site.buttons.begin(), site.buttons.end(), [](const auto& button) { return button.second == show::Button::Go; });
    parts.push_back({"input", Hand::kRate, start, [&](Time moment) {
                         while (const auto key = keys ? keys->poll() : std::nullopt) {
                             using Kind = show::Input::Kind;
                             const auto kind = *key == ' ' ? std::optional(Kind::Go) : *key == 'b' ? std::optional(Kind::Back)
                                               : *key == '0' ? std::optional(Kind::Blackout) : std::nullopt;
                             if (*key == 'q') quit = true;
                             if (!kind) continue;
                             if (!schedule.ended()) news.add("you have the controller");
                             schedule.end();
                             hand.give({moment - start, *kind});
                         }
                         if (schedule.due(moment - start)) {
                             if (simulated && devices.cueController && goButton != site.buttons.end())
                                 for (const bool pressed : {true, false}) world.press(goButton->first, pressed);
                             else
                                 hand.give({moment - start, show::Input::Kind::Go});
                         }
                         hand.tick(moment);
                     }, kInputNiceness});
    parts.push_back({"lighting", Lighting::kRate, start, [&](Time moment) { lighting.tick(moment); }, kLightingNiceness});
    parts.push_back({"relays", kRelayRate, start, [&](Time moment) { lighting.relayTick(moment); }, kLightingNiceness});

    if (simulatedSite) {
        simulatedSite->begin(start);
        std::vector<render::FrameSlot*> slots;
        for (std::size_t output = 0; output < site.outputs.size(); ++output) slots.push_back(&frames.tap(output));
        parts.push_back({"site", kSiteRate, start, [&, slots](Time moment) {
                             for (std::size_t output = 0; output < slots.size(); ++output)
                                 if (slots[output]->update())
                                     world.setFrame(outputNames[output], std::make_shared<const RgbaImage>(slots[output]->value().image));
                             simulatedSite->advanceTo(moment);
                         }, kWatchNiceness});
    }
    parts.push_back({"watch", Watch::kRate, start, [&](Time moment) { watch.tick(moment); }, kWatchNiceness});

    Result<void> recorded;
    if (recording && !site.outputs.empty()) {
        std::vector<render::FrameSlot*> slots;
        for (std::size_t output = 0; output < site.outputs.size(); ++output) slots.push_back(&frames.tap(output));
        const double rate = site.outputs[0].refreshRate;
        // Half a refresh after the frames were shown, so that each of them is met once.
        parts.push_back({"recording", rate, start + tickTime(1, 2 * rate), [&, slots, start](Time) {
                             for (std::size_t output = 0; output < slots.size() && recorded; ++output)
                                 if (slots[output]->update()) {
                                     const render::TappedFrame& frame = slots[output]->value();
                                     recorded = recording->frame(output, frame.image, frame.refresh, frame.showTime);
                                 }
                         }, kWatchNiceness});
    }

    std::int64_t framesBefore = 0;
    parts.push_back({"progress", kProgressRate, start, [&](Time moment) {
                         RunStatus status;
                         status.showTime = moment - start;
                         status.said = news.take();
                         const std::int64_t shown = frames.framesShown();
                         status.framesPerSecond = static_cast<double>(shown - std::exchange(framesBefore, shown)) * kProgressRate;
                         status.lateFrames = frames.framesLate();
                         const auto scores = watch.newestScores();
                         for (std::size_t output = 0; output < scores.size(); ++output) status.zCamera.emplace_back(outputNames[output], scores[output]);
                         progress(status);
                     }, kInputNiceness});

    RunReport report;
    if (!options.asFastAsPossible && !site.outputs.empty()) {
        // What the machine itself misses: a thread of the render thread's rank that does nothing, at the leading output's rate.
        const double rate = site.outputs[0].refreshRate;
        parts.push_back({"yardstick", rate, start, [&, rate, last = std::int64_t{-1}](Time moment) mutable {
                             const std::int64_t tick = tickAt(moment - start, rate);
                             report.yardstickLate += tick - last - 1;
                             ++report.yardstickTicks;
                             last = tick;
                         }, kRenderNiceness});
    }

    {
        std::optional<PartThreads> threads;
        if (options.asFastAsPossible)
            steppedClock.setParts(std::move(parts));
        else
            threads.emplace(clock, std::move(parts));
        while (!interrupt.requested() && !quit && (!options.length || clock.now() - start < *options.length)) TRY(frames.step());
        steppedClock.setParts({});
    }  // the threads have ended here

    report.length = clock.now() - start;
    report.stopReason = options.length && report.length >= *options.length ? "length" : "interrupted";
    report.seed = options.seed;
    report.outputs = frames.outputs();
    report.inputToFrame = frames.inputToFrame();
    report.dmxInterval = lighting.dmxInterval();
    report.cues = hand.cues();
    report.zCamera = watch.series();
    if (simulatedSite)
        for (const site::Happening& happening : simulatedSite->happenings()) report.faults.push_back({happening.at, happening.text});
    TRY(std::move(recorded).in("recording"));
    if (recording) TRY(recording->finish());
    return report;
}

}  // namespace fantascope::app
