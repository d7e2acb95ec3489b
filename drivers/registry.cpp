#include "drivers/registry.h"

#include "drivers/cue_controller/simulated.h"
#include "drivers/dmx/simulated.h"
#include "drivers/modbus/simulated.h"

#include <fmt/format.h>

#include <string_view>

namespace fantascope::drivers {
namespace {

template <class Open>
struct Driver {
    std::string_view name;
    Open* open;
};
template <class Port, class... Arguments>
using Table =
    std::vector<Driver<Result<std::unique_ptr<Port>>(const ConfigNode& options, Arguments..., const Surroundings& around)>>;

// Every driver of the project.
const Table<DisplaySink, const DisplayRequest&> kDisplays = {};
const Table<DmxPort, int> kDmxPorts = {{"simulated", &SimulatedDmxPort::open}};
const Table<DmxSource, int> kDmxSources = {{"simulated", &SimulatedDmxSource::open}};
const Table<RelayBank, const std::vector<bool>&> kRelayBanks = {{"simulated", &SimulatedRelayBank::open}};
const Table<InputBank, std::size_t> kInputBanks = {{"simulated", &SimulatedInputBank::open}};
const Table<CueController> kCueControllers = {{"simulated", &SimulatedCueController::open}};
const Table<CameraSource> kCameras = {};

// What opens the driver that the map's `driver` key names.
template <class Open>
Result<Open*> chosenFrom(const std::vector<Driver<Open>>& table, const ConfigNode& options) {
    std::vector<std::string> names;
    for (const auto& driver : table) names.emplace_back(driver.name);
    for (const auto& [key, node] : TRY(options.entries()))
        if (key == "driver") return table[TRY(node.choice(names))].open;
    return options.error(fmt::format("'driver' is missing, one of {} is needed", fmt::join(names, ", ")));
}

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

Result<std::unique_ptr<RelayBank>> openRelayBank(const ConfigNode& options, const std::vector<bool>& safeStates,
                                                 const Surroundings& around) {
    return TRY(chosenFrom(kRelayBanks, options))(options, safeStates, around);
}

Result<std::unique_ptr<InputBank>> openInputBank(const ConfigNode& options, std::size_t size, const Surroundings& around) {
    return TRY(chosenFrom(kInputBanks, options))(options, size, around);
}

Result<std::unique_ptr<CueController>> openCueController(const ConfigNode& options, const Surroundings& around) {
    return TRY(chosenFrom(kCueControllers, options))(options, around);
}

Result<std::unique_ptr<CameraSource>> openCamera(const ConfigNode& options, const Surroundings& around) {
    return TRY(chosenFrom(kCameras, options))(options, around);
}

}  // namespace fantascope::drivers
