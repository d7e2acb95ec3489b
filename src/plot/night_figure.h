#pragma once
// The figure of a run or a rehearsal: what the camera measured, and what went wrong.

#include "plot/page.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::plot {

// What a run's report says (docs/report.md). Times are seconds of show time.
struct Night {
    // Where the camera saw an output's picture; projector pixels.
    struct Sight {
        double at = 0, drift = 0, sigma = 0, moved = 0;
    };
    struct Output {
        std::string name;
        std::vector<glm::dvec2> z{}, tone{}, iou{};  // time, score; ordered by time
        std::vector<Sight> sights{};                 // ordered by time
    };
    // What kept the wall from being as it should be. Nothing in `to`: it lasted to the end.
    struct Cause {
        std::string output;  // empty: all
        std::string what;
        double from = 0;
        std::optional<double> to{};
    };
    // What the program did against it. Nothing in `to`: it lasted to the end.
    struct Action {
        std::string what;
        double from = 0;
        std::optional<double> to{};
    };
    // The other light on the pictures, beside what is usual, and what of it is ambient light, as
    // shares of the projectors' full light; the share of their levels that the lamps were given.
    struct OtherLight {
        double at = 0, excess = 0, ambient = 0, share = 1;
    };
    struct Fault {
        std::string device;  // may be empty
        std::string what;
        double from = 0;
        std::optional<double> to{};
    };
    struct Cue {
        std::string name;
        double entered = 0;
    };

    double seconds = 0;
    std::int64_t frames = 0, lateFrames = 0;
    std::vector<Output> outputs{};
    std::vector<OtherLight> otherLight{};  // ordered by time; empty: no lamp may be trimmed
    std::vector<Cause> causes{};
    std::vector<Action> actions{};
    std::vector<Fault> faults{};
    std::vector<Cue> cues{};
};

// Charts of z, tone, IoU and drift over the time, each with one line per output; of the other light
// and the lamps; below them a bar for each cause, action and fault. Lines across all charts show
// when the cues were entered. A chart without data is left out.
Page nightFigure(const Night& night);

}  // namespace fantascope::plot
