#pragma once

#include "core/clock.h"
#include "core/config/config.h"
#include "core/result.h"

#include <cstddef>
#include <vector>

namespace fantascope::show {

struct Site;

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
        double gain = 0.1;   // an exchange must win so much of the difference from the guide, 0.05 .. 0.9
        double more = 0.25;  // how many instances it may add, as a share of those that there are, 0 .. 4
        double least = 0.5;  // the least that is left of the picture's light, 0.05 .. 1
        double fade = 6;     // from one pattern to the next, seconds
    } pattern;
    // Ambient light on the pictures, against which the site's own lamps give less.
    struct Lamps {
        Mode mode = Mode::Advise;
        std::vector<std::size_t> fixtures;      // of Site::fixtures, that may be dimmed
        std::vector<std::size_t> relays;        // of Site::relays, that may be switched off, in this order
        double least = 0.3;                     // the least that is left of a fixture's level, 0 .. 1
        double speed = 0.02;                    // of the share that is left, 1/s
        Time hold = std::chrono::seconds(300);  // a relay that was switched stays for this long

        bool any() const { return !fixtures.empty() || !relays.empty(); }
    } lamps;
};

// Reads the section. `site`: its fixtures and relays were read. `isRight`: nothing was wrong with
// them; else names are not looked up. Error: place, key, advice.
Result<Corrections> readCorrections(const ConfigNode& node, const Site& site, bool isRight);

}  // namespace fantascope::show
