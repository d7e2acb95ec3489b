#include "drivers/registry.h"

#include "drivers/camera/camera_search.h"
#include "drivers/camera/simulated.h"
#include "drivers/camera/v4l2.h"
#include "drivers/cue_controller/simulated.h"
#include "drivers/cue_controller/usb_hid.h"
#include "drivers/display/find_monitors.h"
#include "drivers/display/glfw.h"
#include "drivers/display/headless.h"
#include "drivers/dmx/artnet.h"
#include "drivers/dmx/dmx_nodes.h"
#include "drivers/dmx/enttec_pro.h"
#include "drivers/dmx/open_dmx.h"
#include "drivers/dmx/sacn.h"
#include "drivers/dmx/simulated.h"
#include "drivers/dmx/widget_search.h"
#include "drivers/modbus/find.h"
#include "drivers/modbus/input_bank.h"
#include "drivers/modbus/relay_bank.h"
#include "drivers/modbus/simulated.h"

#include <fmt/format.h>

#include <future>
#include <string_view>

namespace fantascope::drivers {
namespace {

// A driver's own open() takes what the port's open function below takes.
template <class Open>
struct Driver {
    std::string_view name;
    Open* open;
};

// Every driver of the project.
constexpr Driver<decltype(openDisplay)> kDisplays[] = {{"headless", &HeadlessDisplay::open}, {"glfw", &GlfwDisplay::open}};
constexpr Driver<decltype(openDmxPort)> kDmxPorts[] = {{"artnet", &ArtnetPort::open},
                                                       {"sacn", &SacnPort::open},
                                                       {"enttec_pro", &EnttecProPort::open},
                                                       {"open_dmx", &OpenDmxPort::open},
                                                       {"simulated", &SimulatedDmxPort::open}};
constexpr Driver<decltype(openDmxSource)> kDmxSources[] = {{"artnet", &ArtnetSource::open},
                                                           {"sacn", &SacnSource::open},
                                                           {"enttec_pro", &EnttecProSource::open},
                                                           {"simulated", &SimulatedDmxSource::open}};
constexpr Driver<decltype(openRelayBank)> kRelayBanks[] = {{"simulated", &SimulatedRelayBank::open},
                                                           {"modbus_tcp", &ModbusRelayBank::openTcp},
                                                           {"modbus_rtu", &ModbusRelayBank::openRtu}};
constexpr Driver<decltype(openInputBank)> kInputBanks[] = {{"simulated", &SimulatedInputBank::open},
                                                           {"modbus_tcp", &ModbusInputBank::openTcp},
                                                           {"modbus_rtu", &ModbusInputBank::openRtu}};
constexpr Driver<decltype(openCueController)> kCueControllers[] = {{"simulated", &SimulatedCueController::open},
                                                                   {"usb_hid", &UsbHidController::open}};
constexpr Driver<decltype(openCamera)> kCameras[] = {{"simulated", &SimulatedCamera::open}, {"v4l2", &V4l2Camera::open}};

// What opens the driver that the map's `driver` key names.
template <class Open, std::size_t kCount>
Result<Open*> chosenFrom(const Driver<Open> (&table)[kCount], const ConfigNode& options) {
    std::vector<std::string> names;
    for (const auto& driver : table) names.emplace_back(driver.name);
    for (const auto& [key, node] : TRY(options.entries()))
        if (key == "driver") return table[TRY(node.choice(names))].open;
    return options.error(fmt::format("'driver' is missing, one of {} is needed", fmt::join(names, ", ")));
}

// What looks for the devices of each family.
using Find = std::vector<FoundDevice> (*)();
constexpr Find kFinds[] = {&findMonitors,    &findWidgets,     [] { return findDmxNodes(); },
                           &findModbusLines, &findControllers, &findCameras};

}  // namespace

Result<std::unique_ptr<DisplaySink>> openDisplay(const ConfigNode& options, const DisplayRequest& request,
                                                 const Surroundings& around) {
    return TRY(chosenFrom(kDisplays, options))(options, request, around);
}

Result<std::unique_ptr<DmxPort>> openDmxPort(const ConfigNode& options, int universe, const Surroundings& around) {
    return TRY(chosenFrom(kDmxPorts, options))(options, universe, around);
}

Result<std::unique_ptr<DmxSource>> openDmxSource(const ConfigNode& options, int universe, const Surroundings& around) {
    return TRY(chosenFrom(kDmxSources, options))(options, universe, around);
}

Result<std::unique_ptr<RelayBank>> openRelayBank(const ConfigNode& options, const std::string& name,
                                                 const std::vector<bool>& safeStates, const Surroundings& around) {
    return TRY(chosenFrom(kRelayBanks, options))(options, name, safeStates, around);
}

Result<std::unique_ptr<InputBank>> openInputBank(const ConfigNode& options, const std::string& name, std::size_t size,
                                                 const Surroundings& around) {
    return TRY(chosenFrom(kInputBanks, options))(options, name, size, around);
}

Result<std::unique_ptr<CueController>> openCueController(const ConfigNode& options, const Surroundings& around) {
    return TRY(chosenFrom(kCueControllers, options))(options, around);
}

Result<std::unique_ptr<CameraSource>> openCamera(const ConfigNode& options, const Surroundings& around) {
    return TRY(chosenFrom(kCameras, options))(options, around);
}

Result<std::vector<DeviceStatus>> lookForDisplays(const std::vector<DisplayQuestion>& questions) {
    std::vector<DeviceStatus> statuses;
    std::vector<MonitorClaim> claims;
    std::vector<std::size_t> claimants;
    for (const auto& [options, request] : questions) {
        const auto open = TRY(chosenFrom(kDisplays, options));
        const bool onMonitor = open == &GlfwDisplay::open;
        statuses.push_back({request.name, onMonitor ? "glfw" : "headless", DeviceState::Running, LossAction::Dark, "", 0});
        if (!onMonitor) continue;
        if (auto claim = TRY(GlfwDisplay::claimOf(options, request))) {
            claims.push_back(std::move(*claim));
            claimants.push_back(statuses.size() - 1);
        }
    }
    if (claims.empty()) return statuses;
    const auto seats = lookForMonitors(claims);
    for (std::size_t i = 0; i < claimants.size(); ++i) {
        std::string why = seats ? (*seats)[i].absence : seats.error().message();
        if (why.empty()) continue;
        statuses[claimants[i]].state = DeviceState::Absent;
        statuses[claimants[i]].detail = std::move(why);
    }
    return statuses;
}

std::vector<FoundDevice> findDevices() {
    std::vector<std::future<std::vector<FoundDevice>>> families;
    for (const Find find : kFinds) families.push_back(std::async(std::launch::async, find));
    std::vector<FoundDevice> found;
    for (auto& family : families)
        for (FoundDevice& device : family.get()) found.push_back(std::move(device));
    return found;
}

}  // namespace fantascope::drivers
