#pragma once

#include "show/course/course.h"
#include "show/course/play_course.h"
#include "show/course/wind.h"
#include "show/cue_list.h"
#include "show/show_state.h"

#include "core/clock.h"
#include "core/wind.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace fantascope::show {

// How everything that is seen moves: the courses of each layer, picture, channel and wind, and the
// state of each relay, as one list moves them. A layer that only adds its light has a course of its
// own. Layers of a picture that is composed in order come and go as a whole. Value type; thread:
// reentrant.
class LookCourses {
public:
    // A look that has been seen forever, in the usual wind.
    explicit LookCourses(const Look& look);

    // From `movement.start` on, the things that it moves go from what is seen at that moment to the
    // cue's look and winds. All others go on as before. Relays switch at once. A source that is
    // seen already does not begin again, unless it is to; another plays from `movement.begun` on,
    // and from the first at the cue's speed.
    LookCourses moved(const Movement& movement, const CueList::Cue& to) const;

    // A channel of a list that nothing else moves, and a relay that it switches at `since`.
    void setLevel(std::size_t channel, float level) { levels_[channel] = Course::at(level); }
    void setRelay(std::size_t relay, bool on, Time since) { relays_[relay] = {on, since}; }
    // When the list last switched a relay, by the end of its last movement; min(): it has no say in
    // it.
    Time switchedAt(std::size_t relay) const { return relays_[relay].since; }

    // Room for the layers and pictures of one output, so that lookAt() need not allocate.
    struct Room {
        std::size_t layers = 0, pictures = 0;
    };
    // What is seen at `time`, not before the start of the last movement.
    void lookAt(Time time, const Room& room, Look& out) const;
    // What is seen where several lists play at once, `room` being that of all. The highest level
    // and the highest opacity of a source count; a source plays as the first list with it says.
    // Composed pictures add their light. A relay is as the list has it that switched it last.
    static void lookAt(std::span<const LookCourses* const> lists, Time time, const Room& room, Look& out);
    // Whether a source is seen at `time` or later.
    bool shows(SourceId source, Time time) const;
    // When a source is over wherever it is seen in the end, but no earlier than `from`; min(): it
    // is not seen. It plays for `length` of its own time. Nothing: it comes to stand before.
    std::optional<Time> whenOver(SourceId source, Time length, Time from) const;
    // The wind of an output at `time`; `lull` is Gusts::lullAt(time).
    Wind windAt(std::size_t output, Time time, double lull) const { return outputs_[output].wind.at(time, lull); }

private:
    struct LayerCourse {
        SourceId source;
        Course opacity;
        Time begun{};
    };
    struct PictureCourse {
        std::vector<LayerState> layers;
        Course share;
    };
    struct OutputCourse {
        std::vector<LayerCourse> layers;
        std::vector<PictureCourse> pictures;
        WindCourse wind{WindWish()};
    };
    struct Play {
        SourceId source;
        PlayCourse course;
    };
    PlayCourse playOf(SourceId source) const;
    void moveSpeeds(const Movement& movement, const CueList::Cue& to);
    void restart(const Movement& movement);
    OutputCourse moved(const OutputCourse& before, const OutputState& from, const OutputState& to, const Movement& movement,
                       std::size_t output) const;

    void addLayers(std::size_t output, Time time, OutputState& out) const;
    void addPictures(std::size_t output, Time time, OutputState& out) const;
    void play(Time time, LayerState& layer) const;

    std::vector<OutputCourse> outputs_;
    std::vector<Course> levels_;
    struct RelayState {
        std::uint8_t on = 0;
        Time since = Time::min();  // when a cue last said so; min(): none has
    };
    std::vector<RelayState> relays_;
    std::vector<Play> plays_;  // of sources whose speed was ever changed
};

}  // namespace fantascope::show
