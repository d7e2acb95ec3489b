#pragma once

#include "pattern/shape/shape_pattern.h"
#include "render/source/picture_source.h"
#include "show/play/event.h"
#include "show/play/input_log.h"
#include "show/show_state.h"
#include "show/site/corrections.h"
#include "vision/watch/canvas_surface.h"
#include "vision/watch/wall_watch.h"

#include "core/clock.h"
#include "media/image.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// A light pattern whose wall the camera watches.
struct PatternOnWall {
    show::SourceId source;
    std::string name;                                      // of the source
    std::shared_ptr<const pattern::ShapePattern> pattern;  // has instances, and was compared in light
    GreyImage guide;                                       // linear light
    vision::CanvasSurface surface;                         // as the calibration saw it
};

// Fits light patterns to the wall that they are shown on. It measures what the wall gives back,
// once a second. When kEnough pictures have told enough of it, a search goes on from the pattern
// that is shown (PatternRefit), on a thread of its own. If that wins much, the new pattern is made
// ready to be drawn, and an input exchanges it for the old one.
//
// Gain: the measured wall does not depend on the pattern, so there is no loop that could swing; one
// exchange does all that can be done. Delay: kEnough pictures, then kSearch pictures for the search
// at least, and those that it takes longer. Bounds: those of the site file. Dead band: an exchange
// must win the share of the site file and kSeen; and no search begins while the wall is as it was
// at the last one.
//
// A rehearsal as fast as possible waits at the picture kSearch for the search, so the same pictures
// give the same show. A run does not wait.
// Thread: bound to the vision thread.
class PatternCorrection {
public:
    static constexpr int kEnough = 30;                             // pictures
    static constexpr int kSearch = 10;                             // pictures
    static constexpr double kSeen = 0.003;                         // of full light: nobody sees a smaller difference in tone
    static constexpr Time kStep = std::chrono::milliseconds(970);  // between pictures

    // Makes ready to draw an exchange of a source's pattern. It has some seconds until then.
    using MakeReady = std::function<void(show::SourceId, int number, const render::PatternSource&)>;

    // All arguments by reference outlive this. `waits`: for each search.
    PatternCorrection(const show::Corrections::Pattern& bounds, std::vector<PatternOnWall> patterns, bool waits,
                      MakeReady makeReady, show::InputLog& inputs, show::EventLog& events);
    ~PatternCorrection();

    // Takes the picture that `wall` has looked at last. `isTrusted`: by output, whether nothing is
    // wrong that would pretend another wall.
    void see(vision::WallWatch& wall, const std::vector<bool>& isTrusted, const show::ShowState& shown, Time showTime);
    // The outputs are set up, or the camera has moved: what the calibration saw of the wall holds
    // no more. What was exchanged stays.
    void end();

private:
    struct Fitted;
    struct Job;
    void measure(vision::WallWatch& wall, const std::vector<bool>& isTrusted);
    void comeAgain(const show::ShowState& shown, Time showTime);
    void begin(const vision::WallWatch& wall);
    void finish(Time showTime);
    void exchange(Time showTime);

    const show::Corrections::Pattern bounds_;
    const bool waits_;
    const MakeReady makeReady_;
    show::InputLog& inputs_;
    show::EventLog& events_;
    std::vector<std::unique_ptr<Fitted>> patterns_;
    std::vector<int> told_;  // by output: pictures that told something of its wall
    std::optional<Time> measured_;
    int pictures_ = 0;
    std::size_t next_ = 0;  // the pattern to look at next
    bool corrects_ = true, isOver_ = false;
    std::unique_ptr<Job> job_;  // the search that runs, or whose pattern is about to come; null: none
};

}  // namespace fantascope::app
