#pragma once

#include "drivers/common/opening.h"

#include "show/site/site.h"

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

// All devices of a site, opened. A device that the site does not have is null or missing here.
struct Devices {
    struct Line {
        int universe = 1;
        std::unique_ptr<DmxPort> port;
        std::unique_ptr<DmxSource> desk;  // null: the site declares no desk
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
    AsDeclared,         // those that the site file names, for a night
    SimulatedHeadless,  // simulated ones with pictures in memory, for a rehearsal
    SimulatedWindows    // the same, with the pictures in windows of the desktop
};

// Error: a driver's, about its part of the site file. A missing device is no error. Thread: the
// render thread, because displays are bound to it.
Result<Devices> openDevices(const show::Site& site, Backends backends, const drivers::DriverContext& context);

}  // namespace fantascope::app
