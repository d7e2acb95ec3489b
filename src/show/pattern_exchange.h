#pragma once

#include "show/source_id.h"

#include "core/clock.h"

#include <map>
#include <vector>

namespace fantascope::show {

// Which of a source's patterns are seen: shares that add up to 1. The exchanges of a source are
// numbered 1, 2, 3, ...; each brings a new pattern in place of the one before.
struct PatternExchange {
    int number = 0;      // of the newest exchange that has begun; 0: none has, and the source's own pattern is seen
    float original = 1;  // share of the source's own pattern
    float previous = 0;  // share of the pattern of the exchange before
    float newest() const { return 1 - original - previous; }
    friend bool operator==(const PatternExchange&, const PatternExchange&) = default;
};

// The exchanges of all sources in time. One begins when the one before is over, so at most two
// patterns are seen of a source at once. A pure function of time and of the calls so far. Thread:
// const functions are reentrant.
class PatternCourses {
public:
    // Begins an exchange: the next one of the source, or the newest again after it was taken back.
    // False: it is neither, and nothing changes. `fade`: from the old pattern to the new one.
    bool exchange(SourceId source, int number, Time at, Time fade);
    // Takes all exchanges back: the sources' own patterns come.
    void takeBack(Time at, Time fade);
    PatternExchange at(SourceId source, Time time) const;

private:
    struct Step {
        Time at{}, fade{};
        int number = 0;
        bool isBack = false;
    };
    std::map<SourceId, std::vector<Step>> steps_;  // by time
};

}  // namespace fantascope::show
