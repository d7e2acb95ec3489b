#pragma once

#include "app/live/recording.h"
#include "app/watch/drift_watch.h"

#include "render/source/picture_feed.h"
#include "render/source/picture_source.h"
#include "show/play/show_clock.h"
#include "show/played_show.h"
#include "theatre/motion/wanted_shadow.h"
#include "vision/compare/guide_comparison.h"
#include "vision/compare/shadow_comparison.h"

#include "device/camera_source.h"

#include "core/latest_value.h"

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::app {

// Watches the site through its camera. It scores each output's picture on the wall against the
// guide of the source that is on it, or its shadow against the silhouette, and keeps the camera's
// last picture of each cue. It knows the show state, the camera's frames and the nominal site, but
// not what really happens at the site.
class Watch {
public:
    // How the shadow of a source on an output is compared.
    struct ShadowScore {
        render::ShadowSource source;
        std::shared_ptr<const theatre::WantedShadow> wanted;
        std::shared_ptr<const vision::ShadowComparison> comparison;
    };
    // The comparisons of an output: for each source of the show that has a guide, and for each
    // shadow whose target is known.
    struct Comparisons {
        show::BySource<std::shared_ptr<const vision::GuideComparison>> guides;
        show::BySource<ShadowScore> shadows;
    };

    // All arguments by reference or pointer outlive this, except `showClock`. `camera`, `pictures`
    // and `recording` may be null. `comparisons`: by output. The camera's pictures are passed on to
    // `pictures`.
    Watch(const show::PlayedShow& show, std::vector<std::string> outputs, std::vector<Comparisons> comparisons,
          CameraSource* camera, render::PictureFeed* pictures, const show::ShowClock& showClock, Recording* recording);

    // Also watches where the pictures stand. `drifts` outlives this. `isSettingUp`: whether a
    // technician moves them now; thread-safe.
    void alsoWatch(DriftWatch& drifts, std::function<bool()> isSettingUp) {
        drifts_ = &drifts;
        isSettingUp_ = std::move(isSettingUp);
    }

    // Hz; how often the camera is polled for a new frame.
    static constexpr double kRate = 50;
    // The slot for the show state that is shown; the render thread writes it.
    LatestValue<show::ShowState>& shown() { return shown_; }
    void tick(Time moment);

    // The newest score of each output, for the status line; negative: none yet. Thread-safe.
    std::vector<std::pair<std::string, double>> newestScores() const;
    // z_camera, tone_camera and iou_camera by output. Call these once the part has ended.
    using Series = std::map<std::string, std::vector<std::pair<Time, double>>>;
    const Series& series() const { return series_; }
    const Series& tones() const { return tones_; }
    const Series& ious() const { return ious_; }

private:
    struct Seen {
        int cue = -1;
        std::shared_ptr<const CameraFrame> frame;
        Time showTime{};
    };
    void see(const std::shared_ptr<const CameraFrame>& frame);
    const show::LayerState* comparedLayer(std::size_t output) const;
    void score(std::size_t output, const CameraFrame& frame, Time showTime);
    void keepForCue(std::shared_ptr<const CameraFrame> frame, Time showTime);

    const show::PlayedShow& show_;
    std::vector<std::string> outputs_;
    std::vector<Comparisons> comparisons_;
    CameraSource* camera_;
    render::PictureFeed* pictures_;
    const show::ShowClock showClock_;
    Recording* recording_;
    DriftWatch* drifts_ = nullptr;
    std::function<bool()> isSettingUp_;
    LatestValue<show::ShowState> shown_;
    std::vector<std::atomic<double>> scores_;
    Seen last_;
    Series series_, tones_, ious_;
};

}  // namespace fantascope::app
