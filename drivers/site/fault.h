#pragma once
// The `faults` of the `simulation:` section, and what they do to the simulated truth; README.md
// lists their keys.

#include "drivers/site/simulated_site.h"

#include "core/clock.h"
#include "core/config/config.h"
#include "media/image.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fantascope::site {

// A fault of the simulated truth. Times count from begin().
struct Fault {
    enum class Kind {
        Unplug,
        Freeze,
        Graphics,
        Bump,
        Fog,
        Dim,
        Defocus,
        Input,
        Ambient,
        Flicker,
        CameraBump,
        Cover,
        Dirt,
        Blind,
        UpsideDown,
        Exposure
    };
    Kind kind = Kind::Unplug;
    Time at{};
    std::optional<Time> until;  // nothing: for good
    Time rise{};                // how long it takes to build up, and to go after `until`
    // Unplug: any device; Freeze: an output or the camera; Graphics, Bump, Dim, Defocus, Input: an
    // output; Flicker: a relay, or empty for all.
    std::string device;
    glm::dvec3 move{0.0}, turn{0.0};  // Bump, CameraBump: along and about its own axes right, down, forward; metres, radians
    double density = 0;               // Fog: extinction per metre at its thickest
    double level = 1;                 // Dim, Ambient, Exposure: times the light; Blind: the stored value, 0..1
    double blur = 0;                  // Defocus: projector pixels; Dirt: camera pixels
    std::shared_ptr<const RgbaImage> picture;  // Input: stored values
    std::string pictureName;                   // for people
    double depth = 0, frequency = 0;           // Flicker: share of the light; Hz
    glm::dvec2 low{0.0}, high{1.0};            // Cover: shares of the camera's picture, from its top left
    glm::dvec3 reflectance{0.1};               // Cover: of the thing, which the ambient light lights
    glm::dvec3 luminance{0.0};                 // Cover: of the thing itself, cd/m2
    double veil = 0;                           // Dirt: share of the picture's mean light that lies over all of it

    // How much of it is there at a time, 0..1.
    double shareAt(Time time) const;
};

// Strict. Reads the picture that the fault names. Error: file, line, column, key.
Result<Fault> readFault(const ConfigNode& node, const NominalSite& nominal);
// What happens, for people: when it begins, or when it ends.
std::string tell(const Fault& fault, bool begins);

// What all faults together make of each part of the site at a time.
double fogAt(std::span<const Fault> faults, Time time);      // extinction per metre
double ambientAt(std::span<const Fault> faults, Time time);  // times ambient light and sky
// Times the light of the street lamp at a relay.
double flickerAt(std::span<const Fault> faults, const std::string& relay, Time time);

struct ProjectorState {
    double level = 1;                          // times its light
    double blur = 0;                           // sigma of a Gaussian, projector pixels
    std::shared_ptr<const RgbaImage> picture;  // instead of our frame; null: our frame
};
ProjectorState projectorAt(std::span<const Fault> faults, const std::string& output, Time time);

struct CameraState {
    std::vector<const Fault*> covers;
    double blur = 0;              // sigma of a Gaussian besides the lens's own, camera pixels
    double veil = 0;              // share of the mean light that is added everywhere
    double gain = 1;              // times the light
    std::optional<double> blind;  // the stored value of every pixel
    bool upsideDown = false;
};
CameraState cameraAt(std::span<const Fault> faults, Time time);

}  // namespace fantascope::site
