#pragma once

#include "show/course.h"
#include "show/cue_list.h"
#include "show/input.h"
#include "show/show_state.h"
#include "show/wind.h"

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
// - Everything that is seen has a course of its own (Course, WindCourse): each layer, picture, channel and wind. A cue that is
// entered
//   gives each a new one, in its `fade`, from what is seen at that moment (the middle of another fade, perhaps) to its look.
//   Layers that only add their light are matched by source. Relays take their new state at once.
// - The wind of each output goes to what the cue asks for without a jump, whether there is light or not.
// - A cue with `follow` is left for the next one by itself, that time after it was entered in whatever way, unless an input
// enters
//   another one first. In a list that loops, the first cue comes after the last.
// - GO is ignored until `goInterval` after a cue was entered, by hand or by itself, so that a trembling or late press skips
// nothing.
// - Blackout dims pictures and levels to nothing in `blackoutFade`, over whatever is running; a second one, or Light, gives them
// back. The
//   cues go on underneath. Relays do not heed it: a dark picture is no reason for dark streets.
// - With a revision the cue of the same name goes on: what is seen goes to its new look in what is left of its fade, at least
//   in the new `blackoutFade`, and it follows on as if it had always been so. If the cue is gone, what is seen stays until an
//   input comes; GO then enters what follows the nearest cue before it that is still there. What was seen before the input
//   stays as it was.
//
// Thread: what is const is reentrant; the rest is bound to one thread at a time and may not run
// beside it.
class Playback {
public:
    explicit Playback(std::shared_ptr<const CueList> list);
    explicit Playback(CueList list) : Playback(std::make_shared<const CueList>(std::move(list))) {}

    // The list that the inputs so far step through.
    const CueList& cues() const { return *entries_.back().list; }

    // Takes one input, or says why not. Inputs take effect in the order in which they are given:
    // one whose time is before that of its forerunner takes effect at its forerunner's time. It
    // changes what is seen from then on and nothing before.
    // `revision`: of an Input::Kind::Revise the list to go on with; null: there is none.
    Outcome apply(const Input& input, std::shared_ptr<const CueList> revision = nullptr);

    // Works out which cues follow by themselves until `time`. Every input does so for one pass of
    // the list, so only a list that loops needs more; the others do nothing here.
    void foresee(Time time);

    // How much of its fade the cue of that time has still before it; 0 once its look is whole, and
    // before the first cue.
    Time fadeLeftAt(Time time) const;
    bool fadesAt(Time time) const { return fadeLeftAt(time) > Time{}; }
    // How long after that time the next cue comes by itself; nothing if it waits for an input.
    std::optional<Time> untilFollowAt(Time time) const;

    // What is seen at `time`, which may be any; a list that loops must have been foreseen until
    // then. Binary searches and one course for each thing; it allocates only when it sees `out` the
    // first time.
    void stateAt(Time time, ShowState& out) const;

private:
    struct LayerCourse {
        SourceId source;
        Course opacity;
        Time begun{};
    };
    // Two looks may show one composition: then its light comes and goes at once.
    struct PictureCourse {
        std::vector<LayerState> layers;
        Course coming, leaving;  // of its share
    };
    struct OutputCourse {
        std::vector<LayerCourse> layers;  // that add as light one by one
        std::vector<PictureCourse> pictures;
        WindCourse wind{WindWish()};
    };
    // A cue that was entered, or that will be by itself if no input comes before; and the courses
    // that it has begun.
    struct Entry {
        Time at = Time::min();
        std::shared_ptr<const CueList> list;
        int cue = -1;                // of `list`
        Time entered = Time::min();  // of the cue; before `at` if a revision has come since
        Time whole = Time::min();    // when all of its look is seen
        std::optional<Time> left;    // when the next cue comes by itself
        bool isGone = false;         // what is seen is of a cue that `list` has not; `cue` is the nearest before
        std::vector<OutputCourse> outputs{};
        std::vector<Course> levels{};
        std::vector<std::uint8_t> relays{};
    };
    // The operator took the light away or gave it back.
    struct Shutter {
        Time at{};
        bool dark = false;
        float from = 1;  // the light's factor then
        Time fade{};     // from full light to none
    };

    const Entry& entryAt(Time time) const;
    int cueAt(Time time) const { return entryAt(time).cue; }
    void examine(const CueList& list);
    void enter(int cue, Time at);
    void put(Entry entry);
    void followOn();
    Outcome revise(std::shared_ptr<const CueList> list, Time at);
    Entry entered(const std::shared_ptr<const CueList>& list, int cue, Time at) const;
    void setOut(Entry& entry, const Look& look, const std::vector<WindWish>& winds, Time fade) const;
    static OutputCourse courseOf(const OutputState& from, const OutputState& to, Time at, Time fade);
    void lookAt(Time time, Look& out) const;
    float lightAt(Time time) const;

    Gusts gusts_;                 // of the first list's seed: they go on
    std::set<SourceId> sources_;  // that looks show: as many layers add as light on one output at most
    struct {
        std::size_t layers = 0, pictures = 0;
    } composed_;                     // of all looks and outputs, more than one output can show in a chain of fades
    std::vector<Entry> entries_;     // by time, those in the future last; the first one is the dark before any cue
    std::vector<Shutter> shutters_;  // by time
    std::vector<Time> taken_;        // when each input took effect
    Time newest_ = Time::min();      // of all inputs, ignored ones included
};

}  // namespace fantascope::show
