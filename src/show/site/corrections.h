#pragma once

#include "core/config/config.h"
#include "core/result.h"

namespace fantascope::show {

// What the program may correct by itself when the camera sees that the wall is not as it should be.
// The site file's section `corrections`.
struct Corrections {
    enum class Mode {
        Off,       // nothing is estimated
        Advise,    // the operator and the report are told, and nothing changes
        Automatic  // corrected, within the bounds
    };
    // An output's picture that has moved on the wall.
    struct Geometry {
        Mode mode = Mode::Advise;
        double farthest = 60;  // how far any point of the picture may be moved, projector pixels
        double speed = 6;      // of the fastest point of the picture, projector pixels per second
    } geometry;
    // Light that the surface and the projectors' fall-off make uneven.
    struct Light {
        Mode mode = Mode::Advise;
        double least = 0.3;    // the least that is left of a place's light, 0.05 .. 1
        double clipped = 0.1;  // share of the places that may stay darker than the others, 0 .. 0.5
    } light;
    // Light patterns that do not read as their guides on the surface that they are shown on.
    struct Pattern {
        Mode mode = Mode::Advise;
        double gain = 0.2;   // an exchange must win so much of the difference from the guide, 0.05 .. 0.9
        double more = 0.25;  // how many instances it may add, as a share of those that there are, 0 .. 4
        double least = 0.5;  // the least that is left of the picture's light, 0.05 .. 1
        double fade = 6;     // from one pattern to the next, seconds
    } pattern;
};

// Reads the section. Error: place, key, advice.
Result<Corrections> readCorrections(const ConfigNode& node);

}  // namespace fantascope::show
