#include "app/live/watch.h"

#include <fmt/format.h>

#include <algorithm>

namespace fantascope::app {

Watch::Watch(const show::PlayedShow& show, std::vector<std::string> outputs, std::vector<Comparisons> comparisons,
             CameraSource* camera, render::PictureFeed* pictures, const show::ShowClock& showClock, Recording* recording)
    : show_(show),
      outputs_(std::move(outputs)),
      comparisons_(std::move(comparisons)),
      camera_(camera),
      pictures_(pictures),
      showClock_(showClock),
      recording_(recording),
      scores_(outputs_.size()) {
    for (std::atomic<double>& score : scores_) score = -1;
    for (const std::string& output : outputs_) series_[output], tones_[output], ious_[output];
}

// The layer whose picture an output shows alone; null if there is none.
const show::LayerState* Watch::comparedLayer(std::size_t output) const {
    // A crossfade of two sources is not compared with either guide. Nor is a picture that is nearly
    // dark, because the camera cannot distinguish it from the night.
    constexpr float kAlone = 0.05f, kBright = 0.5f;
    if (shown_.value().blackout || output >= shown_.value().outputs.size()) return nullptr;
    const show::LayerState* alone = nullptr;
    for (const show::LayerState& layer : shown_.value().outputs[output].layers) {
        if (layer.opacity < kAlone) continue;
        if (alone != nullptr || layer.opacity < kBright) return nullptr;
        alone = &layer;
    }
    return alone;
}

void Watch::score(std::size_t output, const CameraFrame& frame, Time showTime) {
    const show::LayerState* const layer = comparedLayer(output);
    if (layer == nullptr) return;
    const std::string& name = outputs_[output];
    if (const auto* const guide = comparisons_[output].guides.find(layer->source))
        if (const auto seen = (*guide)->compare(frame.image)) {
            series_[name].emplace_back(showTime, seen->z);
            if (seen->tone) tones_[name].emplace_back(showTime, *seen->tone);
            scores_[output] = seen->z;
        }
    const ShadowScore* const shadow = comparisons_[output].shadows.find(layer->source);
    const show::ShowState& shown = shown_.value();
    const Time since = shown.moves ? fromSeconds(seconds(shown.time - showTime) * static_cast<double>(layer->speed)) : Time{};
    const Time played = shown.cueTime - layer->behind - since - layer->begun;
    if (shadow == nullptr || played < Time{}) return;
    const GreyImage& wanted = shadow->wanted->at(render::frameAt(shadow->source, played));
    if (const auto iou = shadow->comparison->compare(frame.image, wanted)) ious_[name].emplace_back(showTime, *iou);
}

void Watch::tick(Time moment) {
    if (camera_ == nullptr) return;
    shown_.update();
    const auto frame = camera_->newest();
    if (frame) see(frame);
    if (drifts_ != nullptr) drifts_->tick(frame, shown_.value(), isSettingUp_(), moment);
}

void Watch::see(const std::shared_ptr<const CameraFrame>& frame) {
    if (pictures_ != nullptr) pictures_->publish({frame, &frame->image});
    const Time showTime = showClock_.showTime(frame->exposed);
    for (std::size_t output = 0; output < outputs_.size(); ++output) score(output, *frame, showTime);
    keepForCue(frame, showTime);
}

void Watch::keepForCue(std::shared_ptr<const CameraFrame> frame, Time showTime) {
    const int cue = shown_.value().cue;
    // Fixtures and relays may be a moment ahead of the pictures, so a cue's last camera frame may
    // already show the next cue. Therefore the frame before it is kept.
    if (recording_ != nullptr && last_.frame && cue >= 0 && cue == last_.cue) {
        const std::string& name = show_.at(shown_.value().revision).show.cues[static_cast<std::size_t>(cue)].name;
        recording_->cue(cue, fmt::format("{} {}  ({:.1f} s)", cue + 1, name, seconds(last_.showTime)), last_.frame->image);
    }
    last_ = {cue, std::move(frame), showTime};
}

std::vector<std::pair<std::string, double>> Watch::newestScores() const {
    std::vector<std::pair<std::string, double>> newest;
    for (std::size_t output = 0; output < scores_.size(); ++output) newest.emplace_back(outputs_[output], scores_[output]);
    return newest;
}

}  // namespace fantascope::app
