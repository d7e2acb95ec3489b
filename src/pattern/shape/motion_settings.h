#pragma once

#include "core/geometry.h"

namespace fantascope::pattern {

// One direction of harmonic motion: a damped oscillator driven by a 1/f^beta excitation (Ji et al.
// 2015, section 4.2).
struct AxisMotion {
    double beta = 1;              // the excitation's amplitude spectrum falls as 1/f^beta; >= 0
    double naturalFrequency = 0;  // Hz, > 0
    double damping = 0;           // ratio to critical damping, 0 < damping < 1
    double magnitude =
        0;  // what the unit excitation is multiplied with; canvas units or radians at rest (a steady unit force moves by 1)
    double range = 0;  // the movement's peak never exceeds this: the response is scaled down to it, never clamped
};

// The numerical parameters of section 4.2. Every default works with any pattern. Lengths in canvas
// heights, angles in radians (degrees in files).
struct MotionSettings {
    int frames = 2000;              // N: samples in one period of the excitation; even, >= 4
    double rate = 30;               // k: samples a second, > 0; the loop lasts frames / rate seconds
    double deviation = 0.1;         // m << 1, >= 0: spread of the spectrum's absolute values relative to their mean
    double direction = 0;           // of the groups' major movement, from the canvas's x axis towards its y axis
    double instancesPerGroup = 20;  // > 0; the number of groups follows from the number of instances
    double fuzziness = 1.5;         // m of fuzzy c-means; > 1
    AxisMotion groupMajor{2, 0.25, 0.35, 0.05, 0.02};             // along `direction`
    AxisMotion groupMinor{2, 0.25, 0.35, 0.015, 0.006};           // across it
    AxisMotion localTranslation{1, 1.0, 0.2, 0.01, 0.004};        // each of two axes
    AxisMotion localTilt{1, 0.8, 0.2, radians(35), radians(20)};  // about x and y
    AxisMotion localTurn{1, 0.8, 0.2, radians(23), radians(14)};  // about z
};

}  // namespace fantascope::pattern
