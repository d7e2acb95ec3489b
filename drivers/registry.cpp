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

// A driver's `read` has the signature of its port's read function below.
template <class Read>
struct Driver {
    std::string_view name;
    Read* read;
};

constexpr Driver<decltype(readDisplay)> kDisplays[] = {{"headless", &HeadlessDisplay::fromConfig},
                                                       {"glfw", &GlfwDisplay::fromConfig}};
constexpr Driver<decltype(readDmxPort)> kDmxPorts[] = {{"artnet", &ArtnetPort::fromConfig},
                                                       {"sacn", &SacnPort::fromConfig},
                                                       {"enttec_pro", &EnttecProPort::fromConfig},
                                                       {"open_dmx", &OpenDmxPort::fromConfig},
                                                       {"simulated", &SimulatedDmxPort::fromConfig}};
constexpr Driver<decltype(readDmxSource)> kDmxSources[] = {{"artnet", &ArtnetSource::fromConfig},
                                                           {"sacn", &SacnSource::fromConfig},
                                                           {"enttec_pro", &EnttecProSource::fromConfig},
                                                           {"simulated", &SimulatedDmxSource::fromConfig}};
constexpr Driver<decltype(readRelayBank)> kRelayBanks[] = {{"simulated", &SimulatedRelayBank::fromConfig},
                                                           {"modbus_tcp", &ModbusRelayBank::readTcp},
                                                           {"modbus_rtu", &ModbusRelayBank::readRtu}};
constexpr Driver<decltype(readInputBank)> kInputBanks[] = {{"simulated", &SimulatedInputBank::fromConfig},
                                                           {"modbus_tcp", &ModbusInputBank::readTcp},
                                                           {"modbus_rtu", &ModbusInputBank::readRtu}};
constexpr Driver<decltype(readCueController)> kCueControllers[] = {{"simulated", &SimulatedCueController::fromConfig},
                                                                   {"usb_hid", &UsbHidController::fromConfig}};
constexpr Driver<decltype(readCamera)> kCameras[] = {{"simulated", &SimulatedCamera::fromConfig},
                                                     {"v4l2", &V4l2Camera::fromConfig}};

// The read function of the driver that the map's `driver` key names.
template <class Read, std::size_t kCount>
Result<Read*> chosenFrom(const Driver<Read> (&table)[kCount], const ConfigNode& options) {
    std::vector<std::string> names;
    for (const auto& driver : table) names.emplace_back(driver.name);
    if (const auto driver = options.find("driver")) return table[TRY(driver->word(names))].read;
    TRY(options.entries());  // it is a map
    return options.error(fmt::format("'driver' is missing, one of {} is needed", fmt::join(names, ", ")));
}

// The search of each family.
using Find = std::vector<FoundDevice> (*)();
constexpr Find kFinds[] = {&findMonitors,    &findWidgets,     [] { return findDmxNodes(); },
                           &findModbusLines, &findControllers, &findCameras};

}  // namespace

Result<Opening<DisplaySink>> readDisplay(const ConfigNode& options, const DisplayRequest& request) {
    return TRY(chosenFrom(kDisplays, options))(options, request);
}

Result<Opening<DmxPort>> readDmxPort(const ConfigNode& options, int universe) {
    return TRY(chosenFrom(kDmxPorts, options))(options, universe);
}

Result<Opening<DmxSource>> readDmxSource(const ConfigNode& options, int universe) {
    return TRY(chosenFrom(kDmxSources, options))(options, universe);
}

Result<Opening<RelayBank>> readRelayBank(const ConfigNode& options, const std::string& name,
                                         const std::vector<bool>& safeStates) {
    return TRY(chosenFrom(kRelayBanks, options))(options, name, safeStates);
}

Result<Opening<InputBank>> readInputBank(const ConfigNode& options, const std::string& name, std::size_t size) {
    return TRY(chosenFrom(kInputBanks, options))(options, name, size);
}

Result<Opening<CueController>> readCueController(const ConfigNode& options) {
    return TRY(chosenFrom(kCueControllers, options))(options);
}

Result<Opening<CameraSource>> readCamera(const ConfigNode& options) { return TRY(chosenFrom(kCameras, options))(options); }

Result<void> SharedUses::add(const ConfigNode& options, const std::vector<Use>& uses) {
    for (const Use& use : uses) {
        const auto [user, isFirst] = users_.try_emplace(use.what, User{use.how, options.place()});
        if (isFirst || (!use.how.empty() && use.how == user->second.how)) continue;
        if (use.how.empty() || user->second.how.empty())
            return options.error(
                fmt::format("{} is already used by the device at {}; each needs its own", use.what, user->second.place));
        return options.error(
            fmt::format("{} is used here with {}, and by the device at {} with {}; all on one line need the same", use.what,
                        use.how, user->second.place, user->second.how));
    }
    return {};
}

Result<std::unique_ptr<DisplaySink>> openDisplay(const ConfigNode& options, const DisplayRequest& request,
                                                 const DriverContext& context) {
    return TRY(readDisplay(options, request)).open(context);
}

Result<std::unique_ptr<DmxPort>> openDmxPort(const ConfigNode& options, int universe, const DriverContext& context) {
    return TRY(readDmxPort(options, universe)).open(context);
}

Result<std::unique_ptr<DmxSource>> openDmxSource(const ConfigNode& options, int universe, const DriverContext& context) {
    return TRY(readDmxSource(options, universe)).open(context);
}

Result<std::unique_ptr<RelayBank>> openRelayBank(const ConfigNode& options, const std::string& name,
                                                 const std::vector<bool>& safeStates, const DriverContext& context) {
    return TRY(readRelayBank(options, name, safeStates)).open(context);
}

Result<std::unique_ptr<InputBank>> openInputBank(const ConfigNode& options, const std::string& name, std::size_t size,
                                                 const DriverContext& context) {
    return TRY(readInputBank(options, name, size)).open(context);
}

Result<std::unique_ptr<CueController>> openCueController(const ConfigNode& options, const DriverContext& context) {
    return TRY(readCueController(options)).open(context);
}

Result<std::unique_ptr<CameraSource>> openCamera(const ConfigNode& options, const DriverContext& context) {
    return TRY(readCamera(options)).open(context);
}

Result<std::vector<DeviceStatus>> lookForDisplays(const std::vector<DisplayQuestion>& questions) {
    std::vector<DeviceStatus> statuses;
    std::vector<MonitorClaim> claims;
    std::vector<std::size_t> claimants;
    for (const auto& [options, request] : questions) {
        const auto read = TRY(chosenFrom(kDisplays, options));
        const bool onMonitor = read == &GlfwDisplay::fromConfig;
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
