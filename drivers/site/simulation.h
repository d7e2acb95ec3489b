#pragma once
// The `simulation:` section of a site file as values; README.md lists its keys.

#include "drivers/site/camera_view.h"
#include "drivers/site/fault.h"
#include "drivers/site/headlights.h"
#include "drivers/site/scene.h"
#include "drivers/site/sensor.h"
#include "drivers/site/simulated_site.h"
#include "drivers/site/walkers.h"

#include "core/clock.h"
#include "core/config/config.h"

#include <glm/vec3.hpp>

#include <optional>
#include <string>
#include <vector>

namespace fantascope::site {

// A projector's properties besides its place, one for each of the nominal site's outputs.
struct SimulatedProjector {
    double lumens = 3500;
    double blackLevel = 0.0005;  // share of full light that a black pixel lets through
    double gamma = 2.2;
    glm::dvec3 white{1};  // strengths of the primaries
};

// A lamp and the index of its fixture or relay in the nominal site.
struct FedLamp {
    std::size_t feed = 0;
    Lamp lamp;
};

struct SimulatedCamera {
    Sensor::Settings sensor;
    Time latency = fromSeconds(0.05);  // from the last row's exposure to the driver
    double frameRate = 10;             // Hz
    double vignetting = 0;             // share of the light that is lost in the picture's corners
    double blur = 0;                   // sigma of the lens's Gaussian, pixels
    Time rolling{};                    // from the first row's exposure to the last row's
};

// Closes a contact for a while, like a person who passes a gate.
struct Closing {
    std::size_t contact = 0;
    Time at{};
    std::optional<Time> until;  // nothing: for good
};

struct Simulation {
    glm::dvec3 ambient{0.2, 0.25, 0.4};  // lux
    glm::dvec3 sky{0.01, 0.015, 0.03};   // cd/m2
    std::vector<SceneObject> objects;
    std::vector<SimulatedProjector> projectors;  // in the order of the nominal outputs
    std::vector<FedLamp> lamps;                  // at fixtures
    std::vector<FedLamp> streetLamps;            // at relays
    SimulatedCamera camera;
    std::vector<Walker> walkers;
    std::vector<Headlight> headlights;
    std::vector<Closing> closings;
    std::vector<Fault> faults;
};

// Strict. Error: file, line, column, key.
Result<Simulation> readSimulation(const ConfigNode& node, const NominalSite& nominal);

}  // namespace fantascope::site
