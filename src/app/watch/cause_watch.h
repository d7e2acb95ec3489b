#pragma once

#include "app/watch/cause_log.h"
#include "app/watch/shown_lately.h"

#include "show/play/event.h"
#include "show/show_state.h"
#include "show/site/site.h"
#include "vision/watch/wall_causes.h"
#include "vision/watch/wall_watch.h"

#include "core/clock.h"
#include "media/image.h"

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::app {

// Names why the wall, or the camera's picture of it, is not as it should be. A cause is named once
// it has lasted, so that people who pass name none, and ends once it is not seen any more. What is
// usual is what the camera sees in the first seconds. Thread: thread-bound.
class CauseWatch {
public:
    // All arguments outlive this.
    CauseWatch(const show::Site& site, vision::WallWatch& wall, CauseLog& causes, show::EventLog& events);

    // Looks at a picture of the camera as such. False: it says nothing of the wall. `isLit`: the
    // outputs show light; pictures of a dark wall may be black, and all alike. Times are show time.
    bool isUsable(const RgbaImage& picture, bool isLit, Time at);
    // The camera has sent nothing since `last`. `period`: of its pictures, as far as it is known.
    void wait(Time last, Time period, Time now);
    // The camera sends too few pictures to watch the wall.
    void noteSlowCamera(Time period, Time at);
    // Nothing more can be said of the wall.
    void endWall(Time at);
    // What was measured.
    struct Measured {
        vision::WallLight light;
        bool isClear = false;  // nothing is wrong with all pictures but ambient light
    };
    // Measures the light in the picture that the wall's watch has looked at last; not more often
    // than is useful. `at`: when the picture was exposed. `shown`: the state that is shown now.
    // Nothing: it measured nothing. `explain`: may correct how much other light was measured before
    // causes are told from it.
    std::optional<Measured> measure(const show::ShowState& shown, Time at,
                                    const std::function<void(vision::WallLight&)>& explain = nullptr);
    // Whether something hides a part of an output's picture, so that its place is not certain.
    bool isHidden(std::size_t output) const { return hidden_[output]; }
    // Whether the camera is saturated by an output's picture, so that its place is not known.
    bool isSaturated(std::size_t output) const { return saturated_[output]; }

private:
    using Name = std::pair<std::string, std::string>;  // output, cause
    struct Suspicion {
        Time since{}, last{};
        bool ofPicture = false;  // told by a picture as such, not by what it shows of the wall
    };
    struct Words {
        std::string cause;   // as in the report
        std::string advice;  // what is seen, and what to do
        Time lasts{};        // a cause is named once it has lasted so long
    };
    void noteLamps(const show::ShowState& shown);
    std::optional<vision::LampState> lampsAt(Time exposed) const;
    void keepWeak(const vision::WallLight& light, std::vector<vision::NamedCause>& named);
    std::string nameOf(const vision::NamedCause& named) const;
    void suspect(const std::string& output, const Words& words, bool ofPicture, Time at);
    void endOthers(bool ofPicture, Time at);
    Words wordsOf(const vision::NamedCause& named) const;

    const show::Site& site_;
    vision::WallWatch& wall_;
    CauseLog& causes_;
    show::EventLog& events_;
    std::map<Name, Suspicion> suspicions_;
    std::vector<bool> hidden_, saturated_;
    std::optional<vision::NamedCause> weak_;  // why all pictures were weak last
    std::optional<Time> measured_;
    ShownLately<vision::LampState> lamps_;
    std::optional<vision::LampState> measuredWith_;  // nothing: they were changing
    std::vector<Rgba8> picture_;                     // some pixels of the last one
};

}  // namespace fantascope::app
