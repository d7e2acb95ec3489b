#include "app/frame_loop.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::app {

FrameLoop::FrameLoop(const show::Site& site, const show::CueList& cues, std::vector<render::PictureSource> sources,
                     std::filesystem::path assets, Devices& devices, Clock& clock)
    : sources_(std::move(sources)), assets_(std::move(assets)), clock_(clock), replica_(cues) {
    for (std::size_t i = 0; i < site.outputs.size(); ++i) {
        outputs_.push_back({site.outputs[i], *devices.displays[i]});
        reports_.push_back({.name = site.outputs[i].name});
    }
}

FrameLoop::~FrameLoop() {
    // What belongs to a context goes while it is current; a context that is lost has taken it along.
    for (Output& output : outputs_) {
        if (!output.display.makeCurrent()) continue;
        output.tap.reset();
        output.renderer.reset();
    }
}

render::FrameReader& FrameLoop::tap(std::size_t output) {
    std::optional<render::FrameTap>& tap = outputs_[output].tap;
    if (!tap) tap.emplace(output, outputs_[output].site.size);
    return tap->addReader();
}

FrameLoop::Output* FrameLoop::leader() {
    const auto running = [](const Output& output) { return output.display.status().state == DeviceState::Running; };
    const auto first = std::find_if(outputs_.begin(), outputs_.end(), running);
    return first == outputs_.end() ? nullptr : &*first;
}

Result<void> FrameLoop::makeRenderer(Output& output) {
    if (output.renderer) return {};
    const render::OutputRenderer::Options options{
        .size = output.display.size(), .corners = output.site.corners, .shaders = assets_ / "shaders"};
    output.renderer = TRY(render::OutputRenderer::create(options, sources_).in("output '" + output.site.name + "'"));
    return {};
}

Result<void> FrameLoop::prepare() {
    show::OutputState everything;
    for (std::uint32_t source = 0; source < sources_.size(); ++source) everything.layers.push_back({source, 1.0f});
    for (Output& output : outputs_) {
        if (!output.display.makeCurrent()) continue;
        TRY(makeRenderer(output));
        for (const show::OutputState& state : {everything, show::OutputState{}})
            output.renderer->draw(state, Wind{}, Time{}, output.display.framebuffer());
    }
    return {};
}

Result<void> FrameLoop::draw(Output& output, std::size_t index, Time showTime, OutputReport& report) {
    output.drawn = false;
    const Time began = clock_.now();
    if (!output.display.makeCurrent()) return {};  // lost; its status says so, and it comes back by itself
    TRY(makeRenderer(output));
    output.renderer->draw(state_.outputs[index], state_.winds[index], showTime, output.display.framebuffer());
    if (output.tap) output.tap->capture(output.display.framebuffer(), showTime);
    report.frame.add(clock_.now() - began);
    output.drawn = true;
    return {};
}

Time FrameLoop::refreshFrom(Time moment) {
    if (const Output* const leads = leader()) {
        std::int64_t number = leads->display.nextRefresh();
        while (leads->display.refreshTime(number) < moment) ++number;
        return leads->display.refreshTime(number);
    }
    // Nothing is to be seen; the show goes on at its pace.
    const double rate = outputs_.empty() ? 1.0 : outputs_[0].site.refreshRate;
    return tickTime(tickAt(std::max(moment, clock_.now()), rate) + 1, rate);
}

void FrameLoop::begin(Time start) {
    start_ = start;
    for (Output& output : outputs_) output.shown = start;  // every refresh after it is one to be met
}

void FrameLoop::countLate(std::size_t output, std::int64_t refreshes) {
    reports_[output].lateFrames += refreshes;
    framesLate_ += refreshes;
}

void FrameLoop::finish(Time end) {
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        // A refresh right at the end belongs to the show, and a display tells its moments to a part of a period only.
        constexpr double kTolerance = 0.1;
        if (const std::optional<Time> shown = std::exchange(outputs_[i].shown, std::nullopt); shown && *shown < end)
            countLate(
                i, static_cast<std::int64_t>(std::floor(seconds(end - *shown) * outputs_[i].display.refreshRate() + kTolerance)));
    }
}

Time FrameLoop::nextDue() { return refreshFrom(Time{}); }

Result<void> FrameLoop::step() {
    Output* const leads = leader();
    // A display that takes the lead may hold no frame yet for a refresh that the others have theirs for.
    if (nextDue() <= newest_) clock_.sleepUntil(newest_);
    const Time due = newest_ = nextDue();
    const Time showTime = due - start_;

    Time oldestInput = Time::max();
    replica_.stateAt(showTime, state_, [&](const show::Input& input) { oldestInput = std::min(oldestInput, input.at); });
    for (std::size_t i = 0; i < outputs_.size(); ++i) TRY(draw(outputs_[i], i, showTime, reports_[i]));

    // The leader waits as its refreshes ask, the others show with it.
    std::optional<Time> seen;
    const auto show = [&](std::size_t i, auto present) {
        Output& output = outputs_[i];
        const std::optional<Time> before = std::exchange(output.shown, std::nullopt);
        if (!output.drawn || !output.display.makeCurrent()) return;
        const Result<Shown> shown = present(output.display);
        if (!shown) return;
        if (output.tap) output.tap->publish(*shown);
        output.shown = shown->at;
        if (!seen) seen = shown->at;
        // Whatever kept us: every refresh since the last one that had a frame counts.
        const double rate = output.display.refreshRate();
        const std::int64_t late =
            before ? std::max<std::int64_t>(0, std::llround(seconds(shown->at - *before) * rate) - 1) : std::int64_t{0};
        ++reports_[i].frames;
        ++framesShown_;
        countLate(i, late);
    };
    if (leads != nullptr)
        show(static_cast<std::size_t>(leads - outputs_.data()), [](DisplaySink& display) { return display.present(); });
    if (!seen) clock_.sleepUntil(due);
    const Time leading = seen.value_or(due);
    for (std::size_t i = 0; i < outputs_.size(); ++i)
        if (&outputs_[i] != leads) show(i, [&](DisplaySink& display) { return display.presentWith(leading); });

    if (seen && oldestInput != Time::max()) inputToFrame_.add(*seen - start_ - oldestInput);
    if (stateSlot_ != nullptr) {
        stateSlot_->writable() = state_;
        stateSlot_->publish();
    }
    return {};
}

}  // namespace fantascope::app
