#pragma once

#include "drivers/common/found_device.h"
#include "drivers/common/surroundings.h"

#include "device/camera_source.h"
#include "device/cue_controller.h"
#include "device/display_sink.h"
#include "device/dmx_port.h"
#include "device/dmx_source.h"
#include "device/input_bank.h"
#include "device/relay_bank.h"

#include "core/config.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace fantascope::drivers {

// Reads a device's options by its driver's name and touches no device: whatever it gives can be
// opened. `options` is the driver's own map in the site file, its `driver:` key included; each
// driver's folder has a README of its keys. Error, with its place in the file: a name that is not
// in the registry (the known ones are listed), or all that is wrong with keys and values.
Result<Opening<DisplaySink>> readDisplay(const ConfigNode& options, const DisplayRequest& request);
Result<Opening<DmxPort>> readDmxPort(const ConfigNode& options, int universe);
Result<Opening<DmxSource>> readDmxSource(const ConfigNode& options, int universe);
// `name`: the bank's, which no other device of the site has. `safeStates`: one for each relay, true
// is energised; their number is the bank's size.
Result<Opening<RelayBank>> readRelayBank(const ConfigNode& options, const std::string& name, const std::vector<bool>& safeStates);
Result<Opening<InputBank>> readInputBank(const ConfigNode& options, const std::string& name, std::size_t size);
Result<Opening<CueController>> readCueController(const ConfigNode& options);
Result<Opening<CameraSource>> readCamera(const ConfigNode& options);

// Whether the devices of one site can be used together.
class SharedUses {
public:
    // Error: another device uses one of these otherwise; its place and `options`' own.
    Result<void> add(const ConfigNode& options, const std::vector<Use>& uses);

private:
    struct User {
        std::string how, place;
    };
    std::map<std::string, User> users_;
};

// The same, opened. A device that is not there opens all the same and is Absent. Error: as above,
// or as Opening::open.
Result<std::unique_ptr<DisplaySink>> openDisplay(const ConfigNode& options, const DisplayRequest& request,
                                                 const Surroundings& around);
Result<std::unique_ptr<DmxPort>> openDmxPort(const ConfigNode& options, int universe, const Surroundings& around);
Result<std::unique_ptr<DmxSource>> openDmxSource(const ConfigNode& options, int universe, const Surroundings& around);
Result<std::unique_ptr<RelayBank>> openRelayBank(const ConfigNode& options, const std::string& name,
                                                 const std::vector<bool>& safeStates, const Surroundings& around);
Result<std::unique_ptr<InputBank>> openInputBank(const ConfigNode& options, const std::string& name, std::size_t size,
                                                 const Surroundings& around);
Result<std::unique_ptr<CueController>> openCueController(const ConfigNode& options, const Surroundings& around);
Result<std::unique_ptr<CameraSource>> openCamera(const ConfigNode& options, const Surroundings& around);

// How the displays of a site are, without a window of theirs: Running is one that could show its
// picture now. Thread: any.
struct DisplayQuestion {
    ConfigNode options;
    DisplayRequest request;
};
Result<std::vector<DeviceStatus>> lookForDisplays(const std::vector<DisplayQuestion>& questions);

// Every device that this machine has, or that answers on its network, whether or not a driver has
// it open; by family. The families are looked through at the same time; a network takes three
// seconds. Devices in use are not disturbed.
std::vector<FoundDevice> findDevices();

}  // namespace fantascope::drivers
