#pragma once
// A night at a site that a seed draws: projectors and a camera before a textured wall, a show of
// moving leaves, lamps that change with the cues, people who walk by, and one fault.

#include "app/watch/drift_watch.h"

#include "show/site/site.h"

#include "core/random.h"

#include <glm/vec2.hpp>

#include <map>
#include <string>
#include <vector>

namespace fantascope::app {

struct NightOptions {
    std::uint64_t seed = 1;
    bool isBusy = false;                // headlights pass, and thin fog comes and goes
    std::string fault;                  // a kind of drawnFaults(), drawn; empty: none
    std::vector<std::string> script{};  // faults as in a site file, with the output NAME for the first output
    int outputs = 0;                    // 0: drawn
    glm::ivec2 camera{640, 360};        // pixels
    double faultAt = 14;                // seconds; it happens within the length of a cue after that
    double faultLasts = 0;              // seconds; 0: for good
    double length = 34;                 // seconds
    bool isSurveyed = true;             // the site was calibrated
    double latency = 0.1;               // of the camera, seconds
    double cameraRate = 5;              // Hz
    double refreshRate = 30;            // of the displays, Hz
    double frameDelay = 0;              // from a frame's moment until the watch gets it, seconds
    double standsStillAt = -1;          // seconds; the watch gets no turn for four seconds from then on; negative: it always does
    std::string geometry = "advise";    // the mode of `corrections`
    std::string lamps{};                // the mode of the lamps' correction; empty: none may be trimmed
    double lampSpeed = 0.05;            // of a trim, 1/s
};

// A kind of fault, and what it should be called.
struct DrawnFault {
    std::string kind;
    std::string cause;  // as in the report
    bool ofOutput = false;
};
const std::vector<DrawnFault>& drawnFaults();

// Where the picture of the output that a bump moves stood at a moment.
struct Placed {
    Time at{};
    double moved = 0;    // how far the bump has moved it on the wall, rms, projector pixels
    double missed = 0;   // how far it is from its place with what the corrections do
    double shifted = 0;  // how far the corrections move it
};

// What the site's lamps did at a moment.
struct LampMoment {
    Time at{};
    double asked = 0, given = 0;  // level of the spot
    bool isLampOn = true;         // the street lamp
};

struct NightResult {
    std::vector<std::string> outputs;
    std::string output;  // that the fault concerns; empty: all
    double faultAt = 0;  // seconds
    std::string drawn;   // the fault as it was drawn, for people
    std::vector<CauseReport> causes;
    std::map<std::string, std::vector<DriftReport>> drifts;
    std::vector<Placed> placed;              // for the fault "bump"
    std::vector<LampMoment> lamps;           // if some may be trimmed
    std::vector<LampReport> otherLight;      // as the watch measured it
    std::string told;                        // to the operator, a line each
    std::map<std::string, double> farthest;  // by output: how far corrections moved a corner at most, projector pixels
};

// Plays a night in simulation, as fast as possible.
NightResult playNight(const NightOptions& options);

}  // namespace fantascope::app
