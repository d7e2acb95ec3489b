#pragma once

#include "drivers/site/world.h"

#include "vision/camera_model.h"

#include "core/clock.h"
#include "core/config.h"
#include "core/result.h"

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::site {

// What the simulated site is told of the nominal one: the parts of the site file that throw light,
// or that have a plug.
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
    std::vector<std::string> devices;  // all that can be unplugged, by their names in World
};

// Something that the fault script did.
struct Happening {
    Time at{};  // since the site's beginning
    std::string text;
};

// The simulated site in one scene: ground, wall and objects, lit by what the simulated devices do
// in World, seen by a camera. A projector shows World::frame() of its output, whoever drew it: a
// headless display, or a real window through the renderer's tap. Faults change the simulated truth,
// never the nominal site that it started from.
//
// Time: everything happens on World's clock, counted from begin(). The same code runs on a thread
// of its own in real time,
//     site->begin(clock.now());
//     while (!stopped) {
//         site->advanceTo(clock.now());
//         clock.sleepUntil(std::min(site->nextEvent(), clock.now() + 100ms));  // so that `stopped` is seen
//     }
// and stepped by a manual clock: call advanceTo() after every step of it.
// Thread: bound to the site's thread; happenings() may be called from any.
class SimulatedSite {
public:
    // `simulation`: the site file's section of that name, see README.md; it reads the meshes named
    // there and works out all light beforehand, which takes about a second. `seed`: of the noise.
    // `world` outlives the site. Error: file, line, column, key.
    static Result<std::unique_ptr<SimulatedSite>> open(const ConfigNode& simulation, const NominalSite& nominal,
                                                       std::uint64_t seed, World& world);
    ~SimulatedSite();

    // Sets the beginning from which faults and camera frames count. Before the first advanceTo(),
    // once.
    void begin(Time at);
    // Makes the faults happen and the contacts move that are due, and lets the camera expose the
    // newest frame that is due; if several are, the older ones are dropped as a real camera's would
    // be. Some milliseconds for a frame, nothing otherwise.
    void advanceTo(Time now);
    // When advanceTo() has something to do next.
    Time nextEvent() const;

    // The faults so far, oldest first.
    std::vector<Happening> happenings() const;

private:
    struct Impl;
    explicit SimulatedSite(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace fantascope::site
