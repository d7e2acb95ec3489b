#pragma once

#include "core/config/config.h"

#include <glm/vec3.hpp>

#include <vector>

namespace fantascope::site {

// A lamp: a small round head whose light falls off from its aim. The intensity at an angle from the
// aim is candela * exp(-(angle / a)^p). a and p make it a half at half the beam angle and a tenth
// at half the field angle, as these angles are defined (ANSI E1.9).
struct Lamp {
    glm::dvec3 position{0.0};        // metres
    glm::dvec3 aim{0, -1, 0};        // unit
    double beam = 0.4, field = 0.6;  // full angles, radians; field > beam
    glm::dvec3 colour{1.0};          // linear RGB, 0..1
    double candela = 1000;           // along the aim
    double radius = 0.1;             // of the luminous head, metres

    double intensity(glm::dvec3 direction) const;  // candela towards a unit direction
};

// A lamp's intensity by the angle from its aim as a table, for a lamp that moves and is asked for
// every sample of every picture. Within a hundredth of candela.
class Beam {
public:
    explicit Beam(const Lamp& lamp);
    // Candela; `cosine`: of the angle from the aim.
    float at(float cosine) const;

private:
    std::vector<float> table_;  // over the sine of half the angle
};

// Reads a lamp with a place. Strict. Error: file, line, column, key.
Result<Lamp> readLamp(const ConfigNode& node);
// Declares the keys of a lamp's light but its candela; call checkBeam() after finish().
void declareBeam(ConfigFields& fields, Lamp& lamp);
Result<void> checkBeam(const Lamp& lamp, const ConfigNode& node);

}  // namespace fantascope::site
