#include "app/watch/drift_watch.h"

#include "vision/watch/registration.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

namespace fantascope::app {
namespace {

using vision::Drift;
using vision::Moved;

constexpr Time kLeastStep = std::chrono::milliseconds(190);  // between pictures that are looked at
constexpr Time kSure = std::chrono::milliseconds(700);       // a movement must be seen for so long
constexpr Time kRefines = std::chrono::seconds(4);           // after a correction, small ones may follow
constexpr double kRefinement = 0.25;                         // pixels: a smaller one is not worth it
constexpr double kInPlace = 0.6;                             // pixels: nobody sees less
const std::string kOutOfPlace = "out of place";
// Causes that do not pretend another wall. What is hidden is not measured.
const std::set<std::string> kHarmless = {"blocked view", "ambient light", "dim projector lamp"};
constexpr double kSlowestCamera = 2;  // seconds between pictures, from which on nothing is predicted

// The rectangle of a projector's pixels that its picture is in.
std::pair<glm::dvec2, glm::dvec2> litBy(const Projection& projection) {
    glm::dvec2 low(projection.size), high(0);
    for (const glm::dvec2 corner : projection.warp.shape().corners) {
        low = glm::min(low, corner);
        high = glm::max(high, corner);
    }
    return {glm::max(low, glm::dvec2(0)), glm::min(high, glm::dvec2(projection.size))};
}

double rmsOf(const show::PictureShift& shift, const Projection& projection) {
    const auto [low, high] = litBy(projection);
    return vision::rmsMovement(show::mapOf(shift, projection.size).value_or(Homography()), low, high);
}

// Whether a frame shows light enough to be seen on the wall.
bool isLit(const GreyImage* light) {
    constexpr double kLit = 0.005;  // of full light
    if (light == nullptr) return false;
    return std::accumulate(light->pixels().begin(), light->pixels().end(), 0.0) >
           kLit * static_cast<double>(light->pixels().size());
}

// How far a shifted picture is from its place.
double missOf(const Drift& drift, const show::PictureShift& shift, const Projection& projection) {
    const Homography shown = show::mapOf(shift, projection.size).value_or(Homography());
    const auto [low, high] = litBy(projection);
    return vision::rmsMovement(shown.inverse() * drift.moved, low, high);
}

std::vector<ShownLight::Output> watchedOf(const show::Site& site, const vision::WallWatch& wall,
                                          const std::vector<ShownLight::Frames>& frames) {
    std::vector<ShownLight::Output> outputs;
    for (std::size_t i = 0; i < site.outputs.size(); ++i)
        outputs.push_back({wall.watches(i) ? frames[i] : ShownLight::Frames(), site.outputs[i].refreshRate});
    return outputs;
}

}  // namespace

DriftWatch::DriftWatch(const show::Site& site, const std::vector<std::optional<vision::WatchedOutput>>& outputs,
                       const vision::CameraLight& light, const std::vector<ShownLight::Frames>& frames, show::InputLog& inputs,
                       show::EventLog& events, const show::ShowClock& showClock)
    : site_(site),
      inputs_(inputs),
      events_(events),
      showClock_(showClock),
      wall_(outputs, site.nominalCamera->size, light),
      light_(watchedOf(site, wall_, frames), wall_, showClock),
      settled_(site.outputs.size()),
      settledAt_(site.outputs.size(), Time::min() / 2),
      causeWatch_(site, wall_, causes_, events) {
    const show::Corrections::Lamps& lamps = site.corrections.lamps;
    if (lamps.mode != show::Corrections::Mode::Off && lamps.any()) lamps_.emplace(site, inputs, events);
    for (std::size_t i = 0; i < site.outputs.size(); ++i) {
        const auto [low, high] = litBy(site.outputs[i].projection);
        tracks_.emplace_back(low, high, outputs[i] && outputs[i]->isSurveyed);
    }
}

void DriftWatch::fitPatterns(std::vector<PatternOnWall> patterns, bool waits, PatternCorrection::MakeReady makeReady) {
    if (!patterns.empty())
        patterns_.emplace(site_.corrections.pattern, std::move(patterns), waits, std::move(makeReady), inputs_, events_);
}

void DriftWatch::tick(std::shared_ptr<const CameraFrame> arrived, const show::ShowState& shown, bool isSettingUp, Time now) {
    const Time showTime = showClock_.showTime(now);
    light_.tick(now);
    if (lamps_) lamps_->tick(showTime);
    if (!arrived && arrived_) causeWatch_.wait(showClock_.showTime(*arrived_), period_, showTime);
    const bool wasSettingUp = std::exchange(wasSettingUp_, isSettingUp);
    if (isSettingUp && !wasSettingUp) endShifts(shown, showTime);
    if (arrived) {
        if (lamps_) lamps_->note(shown);
        note(*arrived, now);
        if (!waiting_ && (!looked_ || arrived->exposed - *looked_ >= kLeastStep)) waiting_ = std::move(arrived);
    }
    if (isSettingUp || wasSettingUp) return beginAgain();
    if (waiting_ && !light_.isComing(waiting_->exposed, now)) look(*std::exchange(waiting_, nullptr), shown, now);
}

void DriftWatch::note(const CameraFrame& frame, Time now) {
    arrived_ = now;
    const auto pictures = static_cast<Time::rep>(frame.sequence - sequence_);
    if (exposed_ && pictures > 0) period_ = (frame.exposed - *exposed_) / pictures;
    if (exposed_ && pictures > 0 && seconds(frame.exposed - *exposed_) < kSlowestCamera) light_.exposed(frame.exposed, period_);
    if (seconds(period_) >= kSlowestCamera) causeWatch_.noteSlowCamera(period_, showClock_.showTime(now));
    exposed_ = frame.exposed;
    sequence_ = frame.sequence;
}

void DriftWatch::look(const CameraFrame& frame, const show::ShowState& shown, Time now) {
    std::vector<const GreyImage*> lights;
    for (std::size_t i = 0; i < tracks_.size(); ++i) lights.push_back(wall_.watches(i) ? light_.at(i, frame.exposed) : nullptr);
    if (!causeWatch_.isUsable(frame.image, std::ranges::any_of(lights, isLit), showClock_.showTime(frame.exposed))) return;
    if (std::ranges::all_of(lights, [](const GreyImage* light) { return light == nullptr; })) return;
    looked_ = frame.exposed;
    const auto sights = wall_.look(frame.image, lights);
    for (std::size_t i = 0; i < tracks_.size(); ++i) tracks_[i].add(frame.exposed, sights[i]);
    // Corrections that were taken back come again once they are allowed again.
    if (shown.corrects && !std::exchange(corrects_, shown.corrects) && !cameraMoved_)
        for (std::size_t i = 0; i < tracks_.size(); ++i)
            if (settled_[i]) correct(i, *settled_[i], showClock_.showTime(now));
    corrects_ = shown.corrects;
    if (!cameraMoved_) measure(shown, showClock_.showTime(frame.exposed), showClock_.showTime(now));
    decide(showClock_.showTime(now));
    note(shown, showClock_.showTime(frame.exposed));
    if (patterns_) fit(shown, showClock_.showTime(now));
}

void DriftWatch::fit(const show::ShowState& shown, Time showTime) {
    if (cameraMoved_) return patterns_->end();
    std::vector<bool> isTrusted(tracks_.size());
    for (std::size_t i = 0; i < tracks_.size(); ++i)
        isTrusted[i] =
            wall_.watches(i) && !causes_.isAnyOpen(site_.outputs[i].name, kHarmless) && !causes_.isAnyOpen("", kHarmless);
    patterns_->see(wall_, isTrusted, shown, showTime);
}

void DriftWatch::measure(const show::ShowState& shown, Time exposed, Time now) {
    if (!lamps_) {
        causeWatch_.measure(shown, exposed);
        return;
    }
    const auto measured = causeWatch_.measure(shown, exposed, [&](vision::WallLight& light) { lamps_->explain(light, exposed); });
    if (measured) lamps_->see(measured->light, measured->isClear, exposed, now);
}

// A technician decides where the pictures stand: shifts end, and nothing that was seen counts.
void DriftWatch::endShifts(const show::ShowState& shown, Time showTime) {
    for (std::size_t i = 0; i < shown.shifts.size(); ++i)
        if (show::farthestOf(shown.shifts[i]) > 0) correct(i, Homography(), showTime);
}
void DriftWatch::beginAgain() {
    if (patterns_) patterns_->end();
    waiting_.reset();
    for (vision::DriftTrack& track : tracks_) track.forget();
    std::ranges::fill(settled_, std::nullopt);
}

void DriftWatch::decide(Time showTime) {
    if (cameraMoved_) return;
    std::vector<std::optional<Drift>> since(tracks_.size());  // since all was right
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
        if (!tracks_[i].now() || causeWatch_.isSaturated(i)) continue;
        if (!settled_[i]) settled_[i] = Homography();
        since[i] = tracks_[i].since(*tracks_[i].now(), *settled_[i]);
    }
    const Moved moved = vision::whatMoved(wall_, since);
    if (moved != moved_) movedSince_ = showTime;
    moved_ = moved;
    const bool isLasting = showTime - movedSince_ >= kSure;
    if (moved != Moved::Unclear) isUnclear_ = false;
    if (moved == Moved::Unclear && isLasting && !std::exchange(isUnclear_, true))
        events_.append({showTime, show::event::MovementUnclear{}});
    if (moved == Moved::Camera && isLasting) {
        cameraMoved_ = true;
        events_.append({showTime, show::event::CameraMoved{}});
        causeWatch_.endWall(showTime);
        causes_.begin("", "camera moved", movedSince_);
        return;
    }
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
        if (!since[i]) continue;
        const bool moves = moved == Moved::Projectors && isLasting && since[i]->isSure() && !causeWatch_.isHidden(i);
        const bool refines =
            showTime - settledAt_[i] < kRefines && since[i]->px > kRefinement && since[i]->px > 3 * since[i]->sigma;
        if (!moves && !refines) continue;
        settled_[i] = tracks_[i].now()->moved;
        if (moves) {
            settledAt_[i] = showTime;
            events_.append({showTime, show::event::PictureMoved{site_.outputs[i].name, since[i]->px}});
            causes_.begin(site_.outputs[i].name, kOutOfPlace, movedSince_);
        }
        correct(i, tracks_[i].now()->moved, showTime);
    }
}

void DriftWatch::correct(std::size_t output, const Homography& moved, Time showTime) {
    if (site_.corrections.geometry.mode != show::Corrections::Mode::Automatic || !corrects_) return;
    inputs_.submit({.at = showTime,
                    .kind = show::Input::Kind::Correct,
                    .source = show::Input::Source::Camera,
                    .which = static_cast<int>(output),
                    .shift = show::shiftOf(moved, site_.outputs[output].size())});
}

void DriftWatch::note(const show::ShowState& shown, Time showTime) {
    if (noted_ && showTime - *noted_ < std::chrono::seconds(1)) return;
    noted_ = showTime;
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
        if (!tracks_[i].now()) continue;
        const show::PictureShift shift = i < shown.shifts.size() ? shown.shifts[i] : show::PictureShift{};
        series_[site_.outputs[i].name].push_back(
            {showTime, tracks_[i].now()->px, tracks_[i].now()->sigma, rmsOf(shift, site_.outputs[i].projection), shift});
        const double left = missOf(*tracks_[i].now(), shift, site_.outputs[i].projection);
        if (left < kInPlace) causes_.end(site_.outputs[i].name, kOutOfPlace, showTime);
    }
}

}  // namespace fantascope::app
