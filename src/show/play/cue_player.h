#pragma once

#include "show/cue_list.h"
#include "show/play/look_courses.h"
#include "show/source_id.h"

#include "core/clock.h"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <vector>

namespace fantascope::show {

// Plays the cues of a list: which cue is on at any moment, and how what is seen moves. All times
// are cue time. A pure function of time and of the calls so far, whose times never decrease.
//
// - Each layer, picture, channel and wind has a course of its own (LookCourses). When a cue is
//   entered, each of them begins a new course after the `wait` of its part of the cue, which lasts
//   the part's `fade`. Until then it goes on as before. The course leads from what is seen at that
//   moment, perhaps the middle of another fade, to the cue's look. Layers that only add their light
//   are matched by source. Relays switch after their part's wait.
// - The wind of each output moves to the wind of the cue without a jump, even while the output is
//   dark.
// - A cue with `follow` enters another cue by itself, that long after it was entered, unless another
//   cue is entered before: the next one, or one of its `followers`, chosen by the list's seed and the
//   number of follows since an input. In a list that loops, the first cue comes after the last. A
//   cue with `endings` waits for the end of what plays, as it is seen; if the list joins late, for
//   its usual end.
// - After a revision the cue of the same name continues. What is seen moves to the cue's new look
//   in the rest of its new fade, but in no less than the new `blackoutFade`. Its follow counts from
//   when the cue was entered. If the cue is gone, what is seen stays until another one is entered,
//   and the nearest previous one that is still there counts as the current one. The past does not
//   change.
// - A cue brings cues of the side lists with it: those that it names, and the starts of all sides if
//   the list comes out of the dark. Into the dark it brings them all.
//
// Thread: const functions are reentrant.
class CuePlayer {
public:
    // How often each cue with `times` has been followed by one of its `followers`, since an input
    // has entered a cue.
    using Turns = std::map<int, int>;
    // A cue, and when it is entered; how many cues have followed by themselves since an input has
    // entered one, and the turns until then.
    struct Position {
        int cue = -1;
        Time entered{};
        int follows = 0;
        Turns turns{};
    };
    // A cue of a side list that the list brings with it.
    struct Brought {
        std::size_t side = 0;  // index into CueList::sides
        int cue = -1;          // -1: the dark before the first
        Time entered{};        // `at` of the entry, or earlier if the list joins late
    };
    // What is seen from a moment on, because of a cue that was entered, or that will follow by
    // itself if no other is entered first. A cue that moves things at different moments has an
    // entry for each.
    struct Entry {
        Time at = Time::min();
        std::shared_ptr<const CueList> list;
        int cue = -1;                   // of `list`; -1: the dark before the first
        Time entered = Time::min();     // when the cue was entered, at `at` or earlier
        Time whole = Time::min();       // when the cue's look is whole
        std::optional<Position> next;   // that follows by itself
        bool isGone = false;            // `list` has lost the cue that is seen; `cue` is the nearest one before it
        std::uint64_t number = 0;       // goes up from entry to entry; the entries of one cue share it
        std::vector<Brought> brings{};  // that are entered now
        LookCourses seen;
    };

    // Begins in the dark before the first cue.
    explicit CuePlayer(std::shared_ptr<const CueList> list);

    // Enters a cue; -1: the dark before the first. `ago`: it was to be entered so long before. Then
    // what has followed by now is entered, with what is left of its fade, but no less than the
    // list's `blackoutFade`, and of its follow.
    void enter(int cue, Time at, Time ago = Time{});
    // Continues with another list for the same site.
    void revise(std::shared_ptr<const CueList> list, Time at);
    // Works out the follows until `time`. What was over before `kept` is forgotten, so that a loop
    // may go on for ever.
    void foresee(Time time, Time kept);
    // Enters a cue as enter() does, because another list brings it. takeBack() undoes it as long as
    // nothing was entered otherwise since.
    void enterBrought(int cue, Time at, Time ago);
    // Undoes everything that was brought after `time`. What it had put an end to comes after all.
    void takeBack(Time time);

    // The list after the newest revision.
    const CueList& cues() const { return *entries_.back().list; }
    // Calls take(at, brought) for everything that entries bring until `until`, by time, but for
    // entries whose numbers are not above `taken`. Returns the number of the last entry.
    std::uint64_t bring(std::uint64_t taken, Time until, auto take) const {
        for (const Entry& entry : entries_) {
            if (entry.at > until) break;
            if (entry.number <= taken) continue;
            taken = entry.number;
            for (const Brought& brought : entry.brings) take(entry.at, brought);
        }
        return taken;
    }
    // The entry of `time`; for a time that is forgotten, the oldest one.
    const Entry& at(Time time) const;
    // The rest of the current cue's fade, and of its wait; 0 once they are over, and before the
    // first cue.
    Time fadeLeftAt(Time time) const;
    Time waitLeftAt(Time time) const;
    // Until the next cue follows by itself; nothing: it does not.
    std::optional<Time> untilFollowAt(Time time) const;
    // The cue that follows then.
    std::optional<int> followerAt(Time time) const;

    // Whether a look of any list so far has a source.
    bool shows(SourceId source) const { return sources_.contains(source); }
    // Whether a source may be seen at `time` or later: the newest list has it, or what was seen
    // with it is not over.
    bool needs(SourceId source, Time time) const;
    // For any output at any time.
    LookCourses::Room room() const;

private:
    void examine(const CueList& list);
    void begin(std::shared_ptr<const CueList> list, std::span<const Position> way, Time at);
    void move(Entry entry, const CueList::Cue& wanted, Time least, bool hasBegun);
    void followMedia(const CueList::Cue& cue);
    void drop(Time at);
    void followOn();

    std::set<SourceId> sources_;  // of all looks: at most so many layers add their light on one output
    LookCourses::Room composed_;  // of all looks and outputs: an upper bound for one output in a chain of fades
    // What a brought cue has put an end to.
    struct Ended {
        Time at{};
        std::uint64_t number = 0;  // of the newest entry before
        std::vector<Entry> rest;   // that was to come after `at`
    };
    std::vector<Ended> ended_;    // by time
    std::uint64_t begun_ = 0;     // entries with a number so far
    std::vector<Entry> entries_;  // by time, future ones last; the first one is the dark before any cue
};

// Whether two looks can be for the same site.
bool isOfOneSite(const Look& a, const Look& b);

// Where a cue of the list `old` is in another list: the cue of the same name, or else the nearest
// previous one that is still there; -1: before the first.
struct FoundCue {
    int cue = -1;
    bool isThere = false;  // the other list has the cue itself
};
FoundCue foundAgain(int cue, const CueList& old, const CueList& list);

}  // namespace fantascope::show
