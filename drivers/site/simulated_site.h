#pragma once

#include "drivers/site/world.h"

#include "vision/camera_model.h"

#include "core/clock.h"
#include "core/config/config.h"
#include "core/result.h"

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::site {

// The nominal site as the simulation gets it: the parts of the site file that throw light or have a
// plug.
struct NominalSite {
    struct Output {
        std::string name;
        vision::CameraModel projector;
    };
    struct Fixture {
        std::string name;
        int universe = 1;
        int address = 1;                    // 1 .. 512, of the first channel
        std::vector<std::string> channels;  // one slot each: "intensity", "red", "green", "blue" give light, others none
    };
    struct Relay {
        std::string name;
        std::string bank;
        std::size_t coil = 0;
    };
    struct Contact {
        std::string name;
        std::string bank;
        std::size_t input = 0;
    };
    std::vector<Output> outputs;
    std::vector<Fixture> fixtures;
    std::vector<Relay> relays;
    std::vector<Contact> contacts;
    std::optional<vision::CameraModel> camera;
    std::vector<std::string> devices;  // everything that can be unplugged, by its name in World
};

// An event of the fault script.
struct Happening {
    Time at{};  // since begin()
    std::string text;
};

// The simulated site as one scene: ground, wall and objects, lit by the simulated devices in World
// and seen by a camera. A projector shows World::frame() of its output, whether from a headless
// display or from a real window through the renderer's tap. Faults change the simulated truth,
// never the nominal site that it started from.
//
// Time: everything happens on World's clock, counted from begin(). In real time, a thread of its
// own runs
//     site->begin(clock.now());
//     while (!stopped) {
//         site->advanceTo(clock.now());
//         clock.sleepUntil(std::min(site->nextEvent(), clock.now() + 100ms));  // sees `stopped`
//     }
// With a manual clock, call advanceTo() after every step of the clock.
// Thread: bound to the site's thread; happenings() may be called from any.
class SimulatedSite {
public:
    // `simulation`: the site file's section of that name, see README.md. Reads the meshes named
    // there and computes all light in advance, which takes about a second. `seed`: of the noise.
    // `world` outlives the site. Error: file, line, column, key.
    static Result<std::unique_ptr<SimulatedSite>> open(const ConfigNode& simulation, const NominalSite& nominal,
                                                       std::uint64_t seed, World& world);
    ~SimulatedSite();

    // Sets the time from which faults and camera frames count. Call once, before the first
    // advanceTo().
    void begin(Time at);
    // Applies all due faults and contact movements, and lets the camera expose the newest due
    // frame. If several frames are due, the older ones are dropped, as by a real camera. Takes some
    // milliseconds per frame, nothing otherwise.
    void advanceTo(Time now);
    // When to call advanceTo() next.
    Time nextEvent() const;

    // The faults so far, oldest first.
    std::vector<Happening> happenings() const;

private:
    struct Impl;
    explicit SimulatedSite(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace fantascope::site
