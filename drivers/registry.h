#pragma once

#include "drivers/common/found_device.h"
#include "drivers/common/opening.h"

#include "device/camera_source.h"
#include "device/cue_controller.h"
#include "device/display_sink.h"
#include "device/dmx_port.h"
#include "device/dmx_source.h"
#include "device/input_bank.h"
#include "device/relay_bank.h"

#include "core/config/config.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace fantascope::drivers {

// Read a device's options by its driver's name, without touching the device. Whatever is returned
// can be opened. `options` is the driver's own map in the site file, with its `driver:` key; each
// driver's folder has a README of its keys. Error, with its place in the file: an unknown driver
// (the known ones are listed), or all wrong keys and values.
Result<Opening<DisplaySink>> readDisplay(const ConfigNode& options, const DisplayRequest& request);
Result<Opening<DmxPort>> readDmxPort(const ConfigNode& options, int universe);
Result<Opening<DmxSource>> readDmxSource(const ConfigNode& options, int universe);
// `name`: of the bank, unique in the site. `safeStates`: one per relay, true is energised; their
// number is the bank's size.
Result<Opening<RelayBank>> readRelayBank(const ConfigNode& options, const std::string& name, const std::vector<bool>& safeStates);
Result<Opening<InputBank>> readInputBank(const ConfigNode& options, const std::string& name, std::size_t size);
Result<Opening<CueController>> readCueController(const ConfigNode& options);
Result<Opening<CameraSource>> readCamera(const ConfigNode& options);

// Checks that the devices of one site can be used together.
class SharedUses {
public:
    // Error: another device uses one of these in another way. It gives the places of both.
    Result<void> add(const ConfigNode& options, const std::vector<Use>& uses);

private:
    struct User {
        std::string how, place;
    };
    std::map<std::string, User> users_;
};

// The same, and open the device. A missing device is Absent, which is no error. Error: as above, or
// as Opening::open.
Result<std::unique_ptr<DisplaySink>> openDisplay(const ConfigNode& options, const DisplayRequest& request,
                                                 const DriverContext& context);
Result<std::unique_ptr<DmxPort>> openDmxPort(const ConfigNode& options, int universe, const DriverContext& context);
Result<std::unique_ptr<DmxSource>> openDmxSource(const ConfigNode& options, int universe, const DriverContext& context);
Result<std::unique_ptr<RelayBank>> openRelayBank(const ConfigNode& options, const std::string& name,
                                                 const std::vector<bool>& safeStates, const DriverContext& context);
Result<std::unique_ptr<InputBank>> openInputBank(const ConfigNode& options, const std::string& name, std::size_t size,
                                                 const DriverContext& context);
Result<std::unique_ptr<CueController>> openCueController(const ConfigNode& options, const DriverContext& context);
Result<std::unique_ptr<CameraSource>> openCamera(const ConfigNode& options, const DriverContext& context);

// The status of a site's displays, without opening their windows. Running: it could show its
// picture now. Thread: any.
struct DisplayQuestion {
    ConfigNode options;
    DisplayRequest request;
};
Result<std::vector<DeviceStatus>> lookForDisplays(const std::vector<DisplayQuestion>& questions);

// Every device on this machine or its network, whether or not a driver has it open; sorted by
// family. The families are searched at the same time; the network takes three seconds. Devices in
// use are not disturbed.
std::vector<FoundDevice> findDevices();

}  // namespace fantascope::drivers
