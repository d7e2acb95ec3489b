#pragma once

#include "app/watch/cause_log.h"
#include "app/watch/cause_watch.h"
#include "app/watch/lamp_watch.h"
#include "app/watch/pattern_correction.h"
#include "app/watch/shown_light.h"

#include "show/play/event.h"
#include "show/play/input_log.h"
#include "show/play/show_clock.h"
#include "show/show_state.h"
#include "show/site/site.h"
#include "vision/watch/drift_track.h"
#include "vision/watch/wall_watch.h"
#include "vision/watch/what_moved.h"

#include "device/camera_source.h"

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// What was known of an output's place at a moment.
struct DriftReport {
    Time at{};             // show time
    double drift = 0;      // how far the picture has moved on the wall without corrections, rms, projector pixels
    double sigma = 0;      // standard deviation of that
    double corrected = 0;  // how far the picture is moved against it
    show::PictureShift shift{};
};

// Watches where the outputs' pictures stand on the wall, and brings them back if the site says so.
// A correction is an input like a press of GO: it is bounded, logged, and taken back by one key.
// Once the camera itself has moved nothing is corrected until the site is calibrated again.
//
// Since the prediction already contains the shift that is shown, the measured drift does not depend
// on the corrections: there is no loop that could swing, whatever the camera's latency.
// Thread: bound to the vision thread; the results once it has ended.
class DriftWatch {
public:
    // All arguments by reference or pointer outlive this, except `showClock`. `outputs`: by output;
    // nothing: it cannot be watched. `light`: how the camera stores light. `frames`: by output.
    DriftWatch(const show::Site& site, const std::vector<std::optional<vision::WatchedOutput>>& outputs,
               const vision::CameraLight& light, const std::vector<ShownLight::Frames>& frames, show::InputLog& inputs,
               show::EventLog& events, const show::ShowClock& showClock);

    // Also fits patterns to the wall. Arguments as PatternCorrection has them.
    void fitPatterns(std::vector<PatternOnWall> patterns, bool waits, PatternCorrection::MakeReady makeReady);

    // Call this often. `arrived`: the camera's newest picture; null: none since the last call.
    // `shown`: the state that is shown. `isSettingUp`: a technician moves the pictures; where they
    // stand afterwards is where they belong.
    void tick(std::shared_ptr<const CameraFrame> arrived, const show::ShowState& shown, bool isSettingUp, Time now);

    // By output, one a second.
    const std::map<std::string, std::vector<DriftReport>>& series() const { return series_; }
    // In the order in which they were noticed.
    const std::vector<CauseReport>& causes() const { return causes_.all(); }
    // Empty unless the site lists lamps that may be trimmed.
    std::vector<LampReport> lamps() const { return lamps_ ? lamps_->series() : std::vector<LampReport>(); }

private:
    void note(const CameraFrame& frame, Time now);
    void look(const CameraFrame& frame, const show::ShowState& shown, Time now);
    void measure(const show::ShowState& shown, Time exposed, Time now);
    void endShifts(const show::ShowState& shown, Time showTime);
    void beginAgain();
    void decide(Time showTime);
    void correct(std::size_t output, const Homography& moved, Time showTime);
    void note(const show::ShowState& shown, Time showTime);
    void fit(const show::ShowState& shown, Time showTime);

    const show::Site& site_;
    show::InputLog& inputs_;
    show::EventLog& events_;
    const show::ShowClock showClock_;
    vision::WallWatch wall_;
    ShownLight light_;
    std::optional<Time> exposed_, looked_;  // the exposure of the newest picture, and of the one that was looked at last
    std::uint64_t sequence_ = 0;
    std::shared_ptr<const CameraFrame> waiting_;  // for the frames that were visible in it
    std::vector<vision::DriftTrack> tracks_;
    std::vector<std::optional<Homography>> settled_;  // by output: where the picture stood when all was right
    std::vector<Time> settledAt_;                     // show time
    vision::Moved moved_ = vision::Moved::Nothing;    // what seems to have moved
    Time movedSince_{};                               // show time
    bool isUnclear_ = false;                          // and the operator knows that it cannot be told
    bool cameraMoved_ = false, wasSettingUp_ = false, corrects_ = true;
    std::map<std::string, std::vector<DriftReport>> series_;
    std::optional<Time> noted_;  // show time of the newest entries of `series_`
    CauseLog causes_;
    CauseWatch causeWatch_;
    std::optional<LampWatch> lamps_;
    std::optional<Time> arrived_;  // when the newest picture came
    Time period_{};                // of the camera's pictures; 0: unknown
    std::optional<PatternCorrection> patterns_;
};

}  // namespace fantascope::app
