#include "app/live/frame_loop.h"

#include "app/base/process_start.h"
#include "app/parts/part.h"
#include "app/site/site_models.h"

#include "render/gpu/handles.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <functional>
#include <utility>

namespace fantascope::app {
namespace {

// The movement of a picture by a shift; nothing: it does not move, or it would fold.
std::optional<Homography> movementOf(const show::PictureShift& shift, const Projection& projection) {
    if (shift == show::PictureShift{}) return std::nullopt;
    const auto map = show::mapOf(shift, projection.size);
    return map && Warp::of(projection.warp.shape().moved(*map)) ? map : std::nullopt;
}

}  // namespace

FrameLoop::FrameLoop(const show::Site& site, const show::InputLog& inputs, render::PictureSources sources,
                     std::filesystem::path assets, Devices& devices, Clock& clock,
                     const std::vector<std::shared_ptr<const GreyImage>>& gains)
    : stock_(std::move(sources)),
      assets_(std::move(assets)),
      clock_(clock),
      replica_(inputs),
      framesShownOn_(site.outputs.size()) {
    for (std::size_t i = 0; i < site.outputs.size(); ++i) {
        outputs_.push_back({site.outputs[i], *devices.displays[i], blendOf(site, i), i < gains.size() ? gains[i] : nullptr});
        outputs_.back().report.name = site.outputs[i].name;
    }
    faults_.resize(outputs_.size());
    unfollowed_.resize(outputs_.size());
    madeSince_.assign(outputs_.size(), kNever);
}

FrameLoop::~FrameLoop() {
    // Objects of a context are destroyed while it is current.
    for (Output& output : outputs_) {
        output.making.reset();  // waits until the attempt has ended
        if (!becomesCurrent(output)) forget(output);
        output.tap.reset();
        output.renderer.reset();
    }
}

render::FrameTap& FrameLoop::tap(std::size_t output) {
    std::unique_ptr<render::FrameTap>& tap = outputs_[output].tap;
    if (!tap) tap = std::make_unique<render::FrameTap>(output, outputs_[output].site.size());
    return *tap;
}

// Makes the output's context current. Returns whether its OpenGL objects can be deleted.
bool FrameLoop::becomesCurrent(Output& output) noexcept {
    try {
        return output.display.context() == output.context && output.display.makeCurrent();
    } catch (...) {
        return false;
    }
}

void FrameLoop::forget(Output& output) {
    const render::gpu::Forgetting forgetting;
    output.renderer.reset();
    if (output.tap) output.tap->forget();
}

void FrameLoop::inHand(const Output& output) { inHand_ = static_cast<std::size_t>(&output - outputs_.data()); }

void FrameLoop::look() {
    for (Output& output : outputs_) {
        output.running = false;
        if (!isHere(output)) continue;
        inHand(output);
        alone(output, [&] {
            output.running = output.display.poll();
            if (output.display.context() == output.context) return;
            forget(output);
            output.context = output.display.context();
            output.retryAt = Time{};  // a new context is a new chance
        });
    }
}

template <class Work>
void FrameLoop::alone(Output& output, const Work& work) {
    try {
        work();
    } catch (const std::exception& failure) {
        giveUp(output, failure.what());
    } catch (...) {
        giveUp(output, "an exception of unknown kind");
    }
}

// After an exception the renderer's state is unknown, so the renderer is dropped.
void FrameLoop::giveUp(Output& output, const char* why) {
    output.running = output.drawn = false;
    output.shown.reset();
    if (!becomesCurrent(output)) forget(output);
    output.renderer.reset();
    settle(output, Error(why));
}

void FrameLoop::tell(std::vector<std::string>& faults, const Output& output, const std::string& fault) {
    const std::lock_guard lock(faultsMutex_);
    faults[static_cast<std::size_t>(&output - outputs_.data())] = fault;
}

std::vector<DeviceStatus> FrameLoop::withFaults(std::vector<DeviceStatus> statuses) const {
    const std::lock_guard lock(faultsMutex_);
    for (std::size_t i = 0; i < faults_.size(); ++i) {
        DeviceStatus& display = statuses[i];  // Devices lists the displays first
        if (display.state != DeviceState::Running) continue;
        if (!unfollowed_[i].empty()) display.trouble = unfollowed_[i];
        const bool hangs = i == inHand_ && clock_.now().count() > hangsFrom_;
        const bool hangsAside = clock_.now() - madeSince_[i] > kHangs;
        if (!hangs && !hangsAside && faults_[i].empty()) continue;
        display.state = DeviceState::Faulted;
        display.detail = faults_[i];
        if (hangsAside) display.detail = "the graphics driver does not answer while this picture is prepared; all else plays on";
        if (hangs)
            display.detail =
                "the X server or the graphics driver does not answer; every picture stands still, lights and relays go on. "
                "Restart the X server if that lasts";
    }
    return statuses;
}

std::vector<OutputReport> FrameLoop::outputs() const {
    std::vector<OutputReport> reports;
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        reports.push_back(outputs_[i].report);
        reports.back().frames = framesShownOn_[i];
    }
    return reports;
}

FrameLoop::Output* FrameLoop::leader() {
    const auto first =
        std::find_if(outputs_.begin(), outputs_.end(), [](const Output& output) { return output.running && !output.faulted; });
    return first == outputs_.end() ? nullptr : &*first;
}

Result<void> FrameLoop::makeRenderer(Output& output, const Projection& projection,
                                     const std::shared_ptr<const render::BlendMap>& blend) {
    const render::OutputRenderer::Options options{
        .projection = projection, .blend = blend, .shaders = assets_ / "shaders", .clock = &clock_, .gain = output.gain};
    auto renderer = TRY(render::OutputRenderer::create(options, *output.sources.all));
    TRY(renderer->warmUp(output.display.framebuffer()));
    renderer->draw({}, Wind{}, Time{}, output.display.framebuffer());
    output.renderer = std::move(renderer);
    output.sources.exchanges = 0;
    output.bends = projection.warp.bends();
    return {};
}

Result<void> FrameLoop::beReady(Output& output) {
    TRY(output.display.makeCurrent());
    if (output.renderer) return {};
    if (output.tap) TRY(output.tap->prepare());
    TRY(makeRenderer(output, output.site.projection, output.blend));
    output.fresh = true;
    return output.display.finish();  // so that the next draw does not wait for this work
}

Result<void> FrameLoop::attempt(Output& output) {
    try {
        return beReady(output);
    } catch (const std::exception& failure) {
        return Error(failure.what());
    } catch (...) {
        return Error("an exception of unknown kind");
    }
}

void FrameLoop::makeAside(Output& output) {
    output.running = false;  // the output is lent
    output.display.release();
    auto making = std::make_unique<Making>();
    making->thread = std::jthread([this, &output, &making = *making] {
        setThreadRank(Rank::Input);  // the pictures that are shown have priority
        making.made = attempt(output);
        output.display.release();
        making.ended = true;
    });
    output.making = std::move(making);
    const std::lock_guard lock(faultsMutex_);
    madeSince_[static_cast<std::size_t>(&output - outputs_.data())] = clock_.now();
}

bool FrameLoop::isHere(Output& output) {
    if (!output.making) return true;
    if (!output.making->ended) return false;
    output.making->thread.join();
    settle(output, output.making->made);
    output.making.reset();
    const std::lock_guard lock(faultsMutex_);
    madeSince_[static_cast<std::size_t>(&output - outputs_.data())] = kNever;
    return true;
}

bool FrameLoop::ready(Output& output, Time now) {
    if (output.faulted && now < output.retryAt) return false;
    if (!output.renderer) output.sources.all = stock_.all();
    if (output.renderer || !makesAside_) return settle(output, attempt(output));
    makeAside(output);
    return false;
}

bool FrameLoop::settle(Output& output, const Result<void>& made) {
    if (made) {
        if (std::exchange(output.faulted, false)) tell(faults_, output, "");
        output.pause = Time{};
        return true;
    }
    output.faulted = true;
    tell(faults_, output, "its picture cannot be drawn: " + made.error().message());
    output.pause = std::clamp(2 * output.pause, kSoonestRetry, kLatestRetry);
    output.retryAt = clock_.now() + output.pause;
    return false;
}

Result<void> FrameLoop::prepare() {
    look();
    const Output *drawn = nullptr, *faulted = nullptr;
    for (Output& output : outputs_) {
        if (output.context == 0) continue;
        (ready(output, clock_.now()) ? drawn : faulted) = &output;
    }
    if (faulted == nullptr || drawn != nullptr) return {};
    return Error("output '" + faulted->site.name + "': " + faults_[static_cast<std::size_t>(faulted - outputs_.data())]);
}

// The settings that hold: those from setting up, else the site file's. While an output is set up
// its picture is not shifted, because the technician decides where it stands.
void FrameLoop::followSettings(Output& output, const show::PictureShift& shift) {
    const bool isNew = output.settings->update() || output.fresh;
    const std::shared_ptr<const OutputSettings>& set = output.settings->value();
    const show::PictureShift now = set && set->overlay ? show::PictureShift{} : shift;
    if (!isNew && now == output.shift) return;
    const bool asMade = std::exchange(output.fresh, false) && !set && now == show::PictureShift{};
    output.shift = now;
    if (asMade) return;
    OutputSettings wanted = set ? *set : OutputSettings{output.site.projection, output.blend, nullptr, nullptr};
    const std::optional<Homography> moved = movementOf(now, wanted.projection);
    if (moved) wanted.projection.warp = *Warp::of(wanted.projection.warp.shape().moved(*moved));
    const auto followed = [&]() -> Result<void> {
        // Only a renderer that was made for a mesh draws a mesh exactly.
        if (wanted.projection.warp.bends() && !output.bends)
            TRY(makeRenderer(output, wanted.projection, wanted.blend));
        else
            TRY(output.renderer->follow(wanted.projection, wanted.blend));
        output.renderer->moveMaps(moved);
        return isNew ? output.renderer->setUp(wanted.overlay.get(), wanted.card.get()) : Result<void>();
    }();
    tell(unfollowed_, output, followed ? "" : "it keeps its previous settings: " + followed.error().message());
}

void FrameLoop::spend(Output& output, FramePart part, Time time) {
    const auto index = static_cast<std::size_t>(part);
    output.spent[index] += time;
    spent_[index] += time;
}

void FrameLoop::draw(std::size_t number, Time showTime) {
    Output& output = outputs_[number];
    output.drawn = false;
    output.spent = {};
    if (!output.running) return;  // its status says why, and it comes back by itself
    inHand(output);
    const Time began = clock_.now();
    if (!ready(output, began)) return;
    followSettings(output, state_.shifts[number]);
    if (const auto taken = stock_.giveTo(*output.renderer, output.sources); !taken)
        tell(unfollowed_, output, "what is new cannot be drawn: " + taken.error().message());
    output.renderer->correctLight(lightShare_);
    output.renderer->draw(state_.outputs[number], state_.winds[number], state_.cueTime, output.display.framebuffer());
    if (output.tap) output.tap->capture(output.display.framebuffer(), showTime);
    const Time uploading = output.renderer->uploading();
    spend(output, FramePart::Upload, uploading);
    spend(output, FramePart::Render, clock_.now() - began - uploading);
    output.drawn = true;
}

void FrameLoop::finish(Output& output) {
    if (!output.drawn) return;
    inHand(output);
    const Time began = clock_.now();
    output.drawn = output.display.finish().has_value();
    spend(output, FramePart::Render, clock_.now() - began);
}

void FrameLoop::drawAll(Time showTime) {
    const Time began = clock_.now();
    replica_.stateAt(showTime, state_, [&](const show::Input& input) { oldestInput_ = std::min(oldestInput_, input.at); });
    for (std::size_t i = 0; i < outputs_.size(); ++i) alone(outputs_[i], [&] { draw(i, showTime); });
    for (Output& output : outputs_) alone(output, [&] { finish(output); });
    if (began >= warmUntil_) held_.drawn(clock_.now() - began);
}

// Waits with a finished frame. Returns whether it is to be drawn again, for an input that came
// meanwhile.
bool FrameLoop::awaitInput(Time due) {
    const Output* const leads = leader();
    if (leads == nullptr || clock_.now() < aheadUntil_) return false;
    const auto until = held_.until(due, fromSeconds(1 / leads->display.refreshRate()));
    if (until) clock_.sleepUntil(*until);
    return until && replica_.hasNews() && clock_.now() < due - held_.again();
}

Time FrameLoop::refreshFrom(Time moment) {
    if (const Output* const leads = leader()) {
        std::int64_t number = leads->display.nextRefresh();
        while (leads->display.refreshTime(number) < moment) ++number;
        return leads->display.refreshTime(number);
    }
    // No display runs; the show goes on at the first output's rate.
    const double rate = outputs_.empty() ? 1.0 : outputs_[0].site.refreshRate;
    return tickTime(tickAt(std::max(moment, clock_.now()), rate) + 1, rate);
}

void FrameLoop::begin(const show::ShowClock& showClock) {
    showClock_ = showClock;
    hangsFrom_ = (showClock.runStart() + kHangs).count();
    aheadUntil_ = warmUntil_ = showClock.runStart() + kWarmUp;
    for (Output& output : outputs_) output.shown = Shown{.at = showClock.runStart()};  // every later refresh needs a frame
}

void FrameLoop::countLate(Output& output, std::int64_t refreshes) {
    if (refreshes <= 0) return;
    if (const Time before = std::exchange(lateAt_, newest_); newest_ > before && newest_ - before < kAhead)
        aheadUntil_ = newest_ + kAhead;
    PartTimes spent;
    std::ranges::transform(spent_, output.spentUntilShown, spent.begin(), std::minus());
    const auto cause = causeOfDelay(spent, fromSeconds(1 / output.display.refreshRate()));
    (cause ? output.report.lateBy[static_cast<std::size_t>(*cause)] : output.report.lateByMachine) += refreshes;
    framesLate_ += refreshes;
}

void FrameLoop::finish(Time end) {
    hangsFrom_ = kNotYet;
    // A refresh right at the end belongs to the show; a display's moments are not exact.
    constexpr double kTolerance = 0.1;  // of a period
    for (Output& output : outputs_) {
        if (const std::optional<Shown> shown = std::exchange(output.shown, std::nullopt); shown && shown->at < end)
            countLate(output, static_cast<std::int64_t>(
                                  std::floor(seconds(end - shown->at) * output.display.refreshRate() + kTolerance)));
        if (output.tap && !output.making)
            alone(output, [&] {
                if (output.display.makeCurrent()) output.tap->finish();
            });
    }
}

Time FrameLoop::nextDue() { return refreshFrom(Time{}); }

void FrameLoop::show(Output& output, const Presenting& present) {
    const std::optional<Shown> before = std::exchange(output.shown, std::nullopt);
    if (!output.drawn) return;
    inHand(output);
    const Result<Shown> shown = present(output.display);
    if (!shown) return;
    output.shown = *shown;
    if (!output.firstShown) output.firstShown = shown->at;
    spend(output, FramePart::Swap, shown->swap);
    // Every refresh since the previous frame counts as late, whatever the reason.
    if (before) countLate(output, std::llround(seconds(shown->at - before->at) * output.display.refreshRate()) - 1);
    output.spentUntilShown = spent_;
    ++framesShownOn_[static_cast<std::size_t>(&output - outputs_.data())];
    ++framesShown_;
    for (std::size_t part = 0; part < kFrameParts; ++part) output.report.took[part].add(output.spent[part]);
}

void FrameLoop::addTo(RunReport& report, bool isMachineTime) const {
    report.swapSkew = swapSkew_;
    report.inputToFrame = inputToFrame_;
    const auto start = isMachineTime ? processStart(clock_) : std::nullopt;
    if (!start || !std::ranges::all_of(outputs_, &std::optional<Time>::has_value, &Output::firstShown)) return;
    const auto last = std::ranges::max_element(outputs_, {}, &Output::firstShown);
    if (last != outputs_.end()) report.startToFrame = *last->firstShown - *start;
}

void FrameLoop::giveToReaders(Output& output) {
    if (!output.tap || !output.shown || !output.display.makeCurrent()) return;
    const Time began = clock_.now();
    output.tap->publish(*output.shown);
    spend(output, FramePart::Render, clock_.now() - began);
}

void FrameLoop::measureSkew() {
    Time first = Time::max(), last = Time::min();
    int swaps = 0;
    for (const Output& output : outputs_) {
        if (!output.shown) continue;
        first = std::min(first, output.shown->swapped);
        last = std::max(last, output.shown->swapped);
        ++swaps;
    }
    if (swaps > 1) swapSkew_.add(last - first);
}

void FrameLoop::step() {
    look();
    Output* const leads = leader();
    // A new leader's next refresh may be one that the other displays already have a frame for.
    if (nextDue() <= newest_) clock_.sleepUntil(newest_);
    const Time due = newest_ = nextDue();
    hangsFrom_ = (due + kHangs).count();
    const Time showTime = showClock_.showTime(due);
    lightShare_ = static_cast<float>(std::clamp(seconds(showClock_.runTime(due)) / seconds(kLightFade), 0.0, 1.0));
    oldestInput_ = Time::max();
    stock_.beginFrame(replica_.playback(), showTime);
    drawAll(showTime);
    if (awaitInput(due)) drawAll(showTime);
    stock_.endFrame();

    // The leader waits for its refresh; the others show their frames with it.
    const auto showOn = [&](Output& output, const Presenting& present) { alone(output, [&] { show(output, present); }); };
    if (leads != nullptr) showOn(*leads, [](DisplaySink& display) { return display.present(); });
    const bool led = leads != nullptr && leads->shown;
    if (!led) clock_.sleepUntil(due);
    const Time leading = led ? leads->shown->at : due;
    for (Output& output : outputs_)
        if (&output != leads) showOn(output, [&](DisplaySink& display) { return display.presentWith(leading); });
    measureSkew();
    for (Output& output : outputs_) alone(output, [&] { giveToReaders(output); });

    const auto seen = std::ranges::find_if(outputs_, [](const Output& output) { return output.shown.has_value(); });
    if (seen != outputs_.end() && oldestInput_ != Time::max())  // an input from before this run has no moment
        if (const auto given = showClock_.momentOf(oldestInput_, showClock_.runStart()))
            inputToFrame_.add(seen->shown->at - *given);
    if (stateSlot_ != nullptr) {
        stateSlot_->writable() = state_;
        stateSlot_->publish();
    }
}

}  // namespace fantascope::app
