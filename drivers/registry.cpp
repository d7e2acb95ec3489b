#include "drivers/registry.h"

#include "drivers/camera/simulated.h"
#include "drivers/cue_controller/simulated.h"
#include "drivers/display/glfw.h"
#include "drivers/display/headless.h"
#include "drivers/dmx/simulated.h"
#include "drivers/modbus/simulated.h"

#include <fmt/format.h>

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
constexpr Driver<decltype(openDmxPort)> kDmxPorts[] = {{"simulated", &SimulatedDmxPort::open}};
constexpr Driver<decltype(openDmxSource)> kDmxSources[] = {{"simulated", &SimulatedDmxSource::open}};
constexpr Driver<decltype(openRelayBank)> kRelayBanks[] = {{"simulated", &SimulatedRelayBank::open}};
constexpr Driver<decltype(openInputBank)> kInputBanks[] = {{"simulated", &SimulatedInputBank::open}};
constexpr Driver<decltype(openCueController)> kCueControllers[] = {{"simulated", &SimulatedCueController::open}};
constexpr Driver<decltype(openCamera)> kCameras[] = {{"simulated", &SimulatedCamera::open}};

// What opens the driver that the map's `driver` key names.
template <class Open, std::size_t kCount>
Result<Open*> chosenFrom(const Driver<Open> (&table)[kCount], const ConfigNode& options) {
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
