#pragma once

#include "app/live/recording.h"

#include "render/source/picture_feed.h"
#include "show/show.h"
#include "show/show_clock.h"
#include "vision/guide_comparison.h"

#include "device/camera_source.h"

#include "core/latest_value.h"

#include <atomic>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace fantascope::app {

// The eye on the site: scores each output's picture on the wall against the guide of the pattern
// that is on it, and keeps what the camera saw of each cue. It is told which cue and sources are
// on, the camera's frames and the nominal site, and nothing of what really happens.
class Watch {
public:
    // What an output is compared with, for each source of the show that can be compared.
    using Comparisons = show::BySource<std::shared_ptr<const vision::GuideComparison>>;

    // All outlive it, but for the clock; `camera`, `pictures` and `recording` may be null.
    // `comparisons[output]`. What the camera sees goes on into `pictures`.
    Watch(const show::Show& show, std::vector<std::string> outputs, std::vector<Comparisons> comparisons, CameraSource* camera,
          render::PictureFeed* pictures, const show::ShowClock& showClock, Recording* recording);

    // How often the camera is asked for a new frame.
    static constexpr double kRate = 50;
    // The state that is shown, from the render thread.
    LatestValue<show::ShowState>& shown() { return shown_; }
    void tick(Time moment);

    // The newest score of each output, for the progress line; negative: none yet. Thread-safe.
    std::vector<double> newestScores() const;
    // Once the part has ended: z_camera by output.
    const std::map<std::string, std::vector<std::pair<Time, double>>>& series() const { return series_; }

private:
    struct Seen {
        int cue = -1;
        std::shared_ptr<const CameraFrame> frame;
        Time showTime{};
    };
    const vision::GuideComparison* comparisonOf(std::size_t output) const;
    void keepForCue(int cue, std::shared_ptr<const CameraFrame> frame, Time showTime);

    const show::Show& show_;
    std::vector<std::string> outputs_;
    std::vector<Comparisons> comparisons_;
    CameraSource* camera_;
    render::PictureFeed* pictures_;
    const show::ShowClock showClock_;
    Recording* recording_;
    LatestValue<show::ShowState> shown_;
    std::vector<std::atomic<double>> scores_;
    Seen last_;
    std::map<std::string, std::vector<std::pair<Time, double>>> series_;
};

}  // namespace fantascope::app
