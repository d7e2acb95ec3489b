#pragma once

#include "show/course/steps.h"
#include "show/cue_list.h"
#include "show/play/input.h"
#include "show/play/look_courses.h"
#include "show/show_state.h"

#include "core/clock.h"

#include <memory>
#include <span>
#include <vector>

namespace fantascope::show {

// What a person does to single lamps and relays, beside and on top of the cues.
//
// - The hand is as one more list: a raised lamp shines at least so bright, and a relay is as the hand
//   has it until a cue switches it after that. A release takes all of this back, and so does the dark
//   before the first cue.
// - A highlight shows one fixture at full, or at a level, also in a blackout, and a solo nothing but
//   that one: for focusing. A panic ends both, and so does the dark before the first cue.
// - A parked fixture stays as it was seen when it was parked, whatever else happens, but for a
//   highlight or solo. A panic and the dark before the first cue let those go that are not dark.
//
// A function of show time and of the calls so far, whose times never decrease. Thread: const
// functions are reentrant.
class HandControls {
public:
    explicit HandControls(const CueList& list);

    static bool takes(Input::Kind kind);
    // Takes an input of such a kind at show time `at`, when cue time is `cueTime`, and `seen` is
    // seen.
    Outcome apply(const Input& input, Time at, Time cueTime, const CueList& list, const Look& seen);
    // Ends what would keep a lamp lit through a panic.
    void letGo(Time at);
    // Ends what would keep anything on.
    void endAll(Time at);
    void forget(Time time);

    // The hand as a list that plays beside the cues'.
    const LookCourses& listAt(Time time) const { return hand_.at(time)->list; }
    bool isSoloAt(Time time) const { return solo_.at(time); }
    // Shows the lamps that are on top of all else, and says what the hand does. `cues`: the lists
    // that play, but for the hand's. `out`: what is seen without these lamps; in a solo it is dark.
    void show(Time time, const CueList& list, std::span<const LookCourses* const> cues, ShowState& out) const;

private:
    // A fixture that stays as it is.
    struct Parked {
        int fixture = -1;
        std::vector<float> levels;
    };
    struct Hand {
        LookCourses list;
        std::vector<RaisedLamp> raised{};       // by fixture
        std::vector<SwitchedRelay> switched{};  // by relay
    };
    Outcome focus(const Input& input, Time at);
    Outcome park(int fixture, Time at, const CueList& list, const Look& seen);
    Outcome raise(const Input& input, Time at, const CueList& list);
    void switchRelay(const Input& input, Time at, Time cueTime);

    const std::shared_ptr<const Hand> idle_;
    Steps<std::shared_ptr<const Hand>> hand_;
    Steps<bool> solo_;
    Steps<int> highlight_{-1};
    Steps<float> highlightLevel_{1};
    Steps<std::vector<Parked>> parked_;  // by fixture
};

}  // namespace fantascope::show
