#pragma once

#include "show/course/lamp_trim.h"
#include "show/course/picture_shift.h"
#include "show/course/wind.h"
#include "show/cue_list.h"
#include "show/input.h"
#include "show/look_courses.h"
#include "show/pattern_exchange.h"
#include "show/show_state.h"

#include "core/clock.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace fantascope::show {

// Plays a cue list: what is seen at any moment of show time, as a pure function of that time and of
// the inputs so far. Asking changes nothing, so the same inputs give the same state in whatever
// order the moments are asked for.
//
// - Each layer, picture, channel and wind has a course of its own (LookCourses). When a cue is entered, each of them begins
//   a new course after the `wait` of its part of the cue, which lasts the part's `fade`. Until then it goes on as before.
//   The course leads from what is seen at that moment, perhaps the middle of another fade, to the cue's look. Layers that
//   only add their light are matched by source. Relays switch after their part's wait.
// - The wind of each output moves to the wind of the cue without a jump, even while the output is dark.
// - A cue with `follow` enters the next cue by itself, that long after it was entered, unless an input enters another cue
//   first. In a list that loops, the first cue comes after the last.
// - GO is ignored for `goInterval` after a cue is entered, by an input or by a follow. So a bouncing or late press skips no
//   cue.
// - A blackout dims pictures and levels to zero in `blackoutFade`, over whatever is running. A second one, or Light, ends it.
//   The cues continue underneath. Blackout does not switch relays: a dark picture is no reason for dark streets.
// - A lock ignores GO, back and jumps that come from the hand controller, a contact or a window. A blackout is taken all the
//   same, for it may be needed, and harms nothing.
// - After a revision the cue of the same name continues. What is seen moves to the cue's new look in the rest of its new
//   fade, but in no less than the new `blackoutFade`. Its follow counts from when the cue was entered. If the cue is gone,
//   what is seen stays until an input comes. GO then enters the cue after the nearest previous one that is still there. The
//   past does not change.
// - A correction moves an output's picture to a shift at the list's `shiftSpeed`. It does not depend on cues.
// - An exchange brings another pattern of a source within the list's `exchangeFade`. It does not depend on cues either.
// - A trim moves the lamps' share at the list's `trim.speed`, and does not depend on cues either. A blackout gives the relays
//   back to the cue, and none is trimmed while it lasts.
//
// Thread: const functions are reentrant. The others are bound to one thread at a time, and no const
// function may run beside them.
class Playback {
public:
    explicit Playback(std::shared_ptr<const CueList> list);
    explicit Playback(CueList list) : Playback(std::make_shared<const CueList>(std::move(list))) {}

    // The cue list after the newest revision.
    const CueList& cues() const { return *entries_.back().list; }

    // Takes one input, or says why not. Inputs take effect in the order of the calls: an input
    // whose time is earlier than that of the previous one takes effect at the previous one's time.
    // It changes what is seen from then on and nothing before.
    // `revision`: only for Input::Kind::Revise, the list to continue with; null: there is none.
    Outcome apply(const Input& input, std::shared_ptr<const CueList> revision = nullptr);

    // Works out the follows until `time`. Every input works them out for one pass of the list, so
    // only a list that loops needs this call. What was seen more than ten minutes before `time` is
    // forgotten, so that a loop may go on for ever.
    void foresee(Time time);

    // The rest of the current cue's fade at `time`; 0 once the fade is over, and before the first
    // cue.
    Time fadeLeftAt(Time time) const;
    // The rest of the current cue's wait at `time`; 0 once it changes what is seen, and before the
    // first cue.
    Time waitLeftAt(Time time) const;
    bool fadesAt(Time time) const { return fadeLeftAt(time) > Time{}; }
    // The time from `time` until the next cue follows by itself; nothing if the current cue waits
    // for an input.
    std::optional<Time> untilFollowAt(Time time) const;

    // What is seen at `time`. Any time will do, but a list that loops must have been foreseen until
    // then. For a time that is forgotten it gives what is oldest. The cost is a few binary searches
    // and the evaluation of each course. The call allocates only when it fills `out` for the first
    // time.
    void stateAt(Time time, ShowState& out) const;

private:
    // What is seen from a moment on, because of a cue that was entered, or that will follow by
    // itself if no input comes first. A cue that moves things at different moments has an entry for
    // each.
    struct Entry {
        Time at = Time::min();
        std::shared_ptr<const CueList> list;
        int cue = -1;                // of `list`
        Time entered = Time::min();  // when the cue was entered, at `at` or earlier
        Time whole = Time::min();    // when the cue's look is whole
        std::optional<Time> left;    // when the next cue follows by itself
        bool isGone = false;         // `list` has lost the cue that is seen; `cue` is the nearest one before it
        LookCourses seen;
    };
    // A blackout began or ended.
    struct Shutter {
        Time at{};
        bool dark = false;
        float from = 1;  // the light's factor at that time
        Time fade{};     // from full light to none
    };

    const Entry& entryAt(Time time) const;
    int cueAt(Time time) const { return entryAt(time).cue; }
    void examine(const CueList& list);
    void enter(int cue, Time at);
    void begin(std::shared_ptr<const CueList> list, int cue, Time at);
    void move(Entry entry, const CueList::Cue& wanted, Time least);
    void drop(Time at);
    void followOn();
    void forget(Time time);
    Outcome correct(const Input& input, const CueList& list, Time at);
    Outcome exchange(const Input& input, const CueList& list, Time at);
    Outcome trim(const LampTrim& trim, const CueList& list, Time at);
    Outcome revise(std::shared_ptr<const CueList> list, Time at);
    float lightAt(Time time) const;
    bool correctsAt(Time time) const;
    bool isLockedOut(const Input& input, Time at) const;

    Gusts gusts_;                 // of the first list's seed; a revision does not change them
    std::set<SourceId> sources_;  // of all looks: at most so many layers add their light on one output
    struct {
        std::size_t layers = 0, pictures = 0;
    } composed_;                     // of all looks and outputs: an upper bound for one output in a chain of fades
    std::vector<Entry> entries_;     // by time, future ones last; the first one is the dark before any cue
    std::vector<Shutter> shutters_;  // by time
    ShiftCourses shifts_;
    PatternCourses patterns_;
    TrimCourses trims_;
    std::vector<Time> corrections_;  // when corrections were forbidden and allowed, in turn
    std::vector<Time> locks_;        // when the lock was closed and opened, in turn
    std::vector<Time> taken_;        // when each input took effect
    Time newest_ = Time::min();      // the latest time of all inputs, including ignored ones
};

}  // namespace fantascope::show
