#pragma once

#include "drivers/common/opening.h"

#include "show/site.h"

#include "device/camera_source.h"
#include "device/cue_controller.h"
#include "device/display_sink.h"
#include "device/dmx_port.h"
#include "device/dmx_source.h"
#include "device/input_bank.h"
#include "device/relay_bank.h"

#include "core/result.h"

#include <memory>
#include <vector>

namespace fantascope::app {

// Every device of a site, opened. What the site does not have is null or missing here.
struct Devices {
    struct Line {
        int universe = 1;
        std::unique_ptr<DmxPort> port;
        std::unique_ptr<DmxSource> desk;  // null: nobody else sends this universe
    };
    std::vector<std::unique_ptr<DisplaySink>> displays;  // one for each of Site::outputs
    std::vector<Line> lines;                             // one for each of Site::universes
    std::vector<std::unique_ptr<RelayBank>> relayBanks;  // one for each of Site::relayBanks
    std::unique_ptr<CueController> cueController;
    std::vector<std::unique_ptr<InputBank>> contactBanks;  // one for each of Site::contactBanks
    std::unique_ptr<CameraSource> camera;

    std::vector<DeviceStatus> statuses() const;
};

// Which drivers to open.
enum class Backends {
    AsDeclared,         // what the site file names: the night
    SimulatedHeadless,  // the simulated ones, pictures in memory, whatever the site file names: a rehearsal
    SimulatedWindows    // the same with the pictures in windows of the desktop
};

// Error: what a driver says of its part of the site file. A device that is not there is no error.
// Thread: the render thread, since displays are bound to it.
Result<Devices> openDevices(const show::Site& site, Backends backends, const drivers::DriverContext& context);

}  // namespace fantascope::app
