#pragma once

#include "show/course/cue_time.h"
#include "show/course/dimmer.h"
#include "show/course/lamp_trim.h"
#include "show/course/picture_shift.h"
#include "show/course/steps.h"
#include "show/course/wind.h"
#include "show/cue_list.h"
#include "show/pattern_exchange.h"
#include "show/play/cue_player.h"
#include "show/play/hand_controls.h"
#include "show/play/input.h"
#include "show/show_state.h"

#include "core/clock.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace fantascope::show {

// Plays a cue list under the hands of an operator: what is seen at any moment of show time, as a
// pure function of that time and of the inputs so far. Asking changes nothing, so the same inputs
// give the same state in whatever order the moments are asked for. How cues move what is seen,
// CuePlayer says.
//
// - GO enters the loaded cue if one is loaded, else the next one. It is ignored for `goInterval`
//   after a cue was entered, by an input or by a follow, and after cue time went on. So a bouncing
//   or late press skips no cue.
// - A loaded cue stays loaded while cues follow by themselves, until an input enters a cue.
// - A pause lets cue time stand still: waits, fades, follows, videos, shadows and patterns. A second
//   one, or GO, lets it go on. Back and jumps do so, too.
// - A freeze keeps what is seen, while the cues go on underneath. A second one shows them again at
//   once. A jump to the dark ends it, too.
// - A blackout dims pictures and levels to zero in `blackoutFade`, over whatever is running. A second
//   one, or Light, ends it. The cues continue underneath. Blackout does not switch relays: a dark
//   picture is no reason for dark streets.
// - A panic dims pictures and levels to zero in `panicFade`, switches the relays to their safe states
//   at once, and lets cue time stand still. A second one makes all dark at once. Until Restore, no
//   input enters a cue, pauses or freezes. Restore brings the light back in `blackoutFade`, and
//   everything goes on from where it was.
// - The master dims pictures and levels, on top of blackout and panic. From full to none it takes
//   `blackoutFade`.
// - What a person does to single lamps and relays, HandControls says.
// - A late input is ignored, so that a machine that was busy does not fire what was pressed meanwhile
//   in a burst. Only darkness comes however late it is; a late toggle of the blackout never ends it.
// - A lock ignores what comes from the hand controller, a contact or a window, but for blackout,
//   panic and their ends, which may be needed, and harm nothing.
// - A revision continues with another list (CuePlayer). A loaded cue stays loaded if the new list
//   has it.
// - The lists beside the main one play by the same cue time. GO, back, jumps and loads go to the list
//   that the input names; each list has its own interval between them. A cue of the main list may
//   enter cues of the others. The highest level and opacity count, and a relay is as the list has it
//   that switched it last (LookCourses). Each output's wind is moved by one of the lists.
// - A correction moves an output's picture to a shift at the list's `shiftSpeed`, an exchange brings
//   another pattern of a source within the list's `exchangeFade`, and a trim moves the lamps' share
//   at the list's `trim.speed`. None of them depends on cues or on cue time. A blackout or a panic
//   gives the relays back, and none is trimmed while it lasts.
//
// Thread: const functions are reentrant. The others are bound to one thread at a time, and no const
// function may run beside them.
class Playback {
public:
    explicit Playback(std::shared_ptr<const CueList> list);
    explicit Playback(CueList list) : Playback(std::make_shared<const CueList>(std::move(list))) {}

    // The cue list after the newest revision.
    const CueList& cues() const { return main().cues(); }

    // Takes one input, or says why not. Inputs take effect in the order of the calls: an input
    // whose time is earlier than that of the previous one takes effect at the previous one's time.
    // It changes what is seen from then on and nothing before.
    // `revision`: only for Input::Kind::Revise, the list to continue with; null: there is none.
    Outcome apply(const Input& input, std::shared_ptr<const CueList> revision = nullptr);

    // Works out the follows until `time`. Every input works them out for one pass of the list, so
    // only a list that loops, or has others beside it, needs this call. What was seen more than ten
    // minutes before `time` is forgotten, so that a loop may go on for ever.
    void foresee(Time time);

    // The rest of the current cue's fade at `time`, in cue time; 0 once the fade is over, and
    // before the first cue. `list`: as Input::list.
    Time fadeLeftAt(Time time, int list = 0) const { return playerOf(list).fadeLeftAt(cueTime_.at(time)); }
    bool fadesAt(Time time, int list = 0) const { return fadeLeftAt(time, list) > Time{}; }
    // The rest of the current cue's wait at `time`, in cue time; 0 once it changes what is seen,
    // and before the first cue.
    Time waitLeftAt(Time time, int list = 0) const { return playerOf(list).waitLeftAt(cueTime_.at(time)); }
    // The cue time from `time` until the next cue follows by itself; nothing if the current cue
    // waits for an input.
    std::optional<Time> untilFollowAt(Time time, int list = 0) const { return playerOf(list).untilFollowAt(cueTime_.at(time)); }
    // The cue that follows then.
    std::optional<int> followerAt(Time time, int list = 0) const { return playerOf(list).followerAt(cueTime_.at(time)); }

    // The time by which the cues go on. While something is frozen, ShowState::cueTime stands still, and
    // this does not.
    Time cueTimeAt(Time time) const { return cueTime_.at(time); }

    // Whether a source may be seen at `time` or later, unless the list is revised.
    bool needs(SourceId source, Time time) const;

    // What is seen at `time`. Any time will do, but a list that loops, or has others beside it,
    // must have been foreseen until then. For a time that is forgotten it gives what is oldest. The
    // cost is a few binary searches and the evaluation of each course. The call allocates only when
    // it fills `out` for the first time.
    void stateAt(Time time, ShowState& out) const;

private:
    static constexpr int kNoCue = -1;
    // What is seen during a freeze.
    struct Frozen {
        std::vector<LookCourses> seen;  // of each list
        Time cueTime{};
    };
    // A list, and the cue that GO is to enter in it: of the list of its time.
    struct Played {
        CuePlayer player;  // in cue time
        Steps<int> loaded{kNoCue};
    };

    Outcome take(const Input& input, Time at, std::shared_ptr<const CueList> revision);
    Outcome moveOn(const Input& input, Time at);
    Outcome hold(Input::Kind kind, Time at);
    Outcome correct(const Input& input, const CueList& list, Time at);
    Outcome exchange(const Input& input, const CueList& list, Time at);
    Outcome trim(const LampTrim& trim, const CueList& list, Time at);
    Outcome revise(std::shared_ptr<const CueList> list, Time at);
    void letGoOn(Time at);
    const CuePlayer& main() const { return lists_.front().player; }
    const CuePlayer& playerOf(int list) const { return lists_[static_cast<std::size_t>(list)].player; }
    ListPlace placeAt(Time time, const Played& list) const;
    void foreseeCues(Time time);
    void bring(Time at, const CuePlayer::Brought& brought);
    void takeBackSides(Time time);
    void freeze(Time at);
    Outcome doByHand(const Input& input, const CueList& list, Time at);
    bool isPanicAt(Time time) const { return panic_.wantedAt(time) < 1; }
    static bool isTooLate(const Input& input);
    bool isLockedOut(const Input& input, Time at) const;

    Gusts gusts_;                // of the first list's seed; a revision does not change them
    std::vector<Played> lists_;  // the main one, then CueList::sides
    Time sidesKnown_{};          // cue time until which the sides know what the main list brings
    std::uint64_t brought_ = 0;  // the number of the main list's last entry by then
    CueTime cueTime_;
    Dimmer blackout_, panic_, master_;
    Steps<std::shared_ptr<const Frozen>> frozen_;  // null: nothing is frozen
    Steps<bool> paused_, locked_, corrects_{true};
    HandControls hand_;
    ShiftCourses shifts_;
    PatternCourses patterns_;
    TrimCourses trims_;
    Steps<std::uint64_t> taken_;      // how many inputs have taken effect
    Steps<std::uint64_t> revisions_;  // how many of them have revised the list
    std::optional<Time> wentOn_;      // when cue time went on last
    Time newest_ = Time::min();       // the latest time of all inputs, including ignored ones
};

}  // namespace fantascope::show
