#pragma once

#include "core/geometry.h"

namespace fantascope::pattern {

// Harmonic motion along one axis: a damped oscillator driven by a 1/f^beta excitation (Ji et al.
// 2015, section 4.2).
struct AxisMotion {
    double beta = 1;              // the excitation's amplitude spectrum falls as 1/f^beta; >= 0
    double naturalFrequency = 0;  // Hz, > 0
    double damping = 0;           // ratio to critical damping, 0 < damping < 1
    // What the unit excitation is multiplied by: canvas heights or radians, since a constant unit
    // force displaces by 1.
    double magnitude = 0;
    double range = 0;  // upper bound of the displacement; a larger response is scaled down as a whole, never clamped
};

// The numerical parameters of Ji et al. 2015, section 4.2. The defaults work with any pattern.
// Lengths in canvas heights, angles in radians (degrees in files).
struct MotionSettings {
    int frames = 2000;              // N: samples in one period of the excitation; even, >= 4
    double rate = 30;               // k: samples per second, > 0; the loop lasts frames / rate seconds
    double deviation = 0.1;         // m << 1, >= 0: standard deviation of the spectral amplitudes relative to their mean
    double direction = 0;           // of the groups' major axis, from the canvas's x axis towards its y axis
    double instancesPerGroup = 20;  // > 0; the number of groups follows from the number of instances
    double fuzziness = 1.5;         // m of fuzzy c-means; > 1
    AxisMotion groupMajor{2, 0.25, 0.35, 0.05, 0.02};             // along `direction`
    AxisMotion groupMinor{2, 0.25, 0.35, 0.015, 0.006};           // across it
    AxisMotion localTranslation{1, 1.0, 0.2, 0.01, 0.004};        // along x and along y
    AxisMotion localTilt{1, 0.8, 0.2, radians(35), radians(20)};  // about x and y
    AxisMotion localTurn{1, 0.8, 0.2, radians(23), radians(14)};  // about z
};

}  // namespace fantascope::pattern
