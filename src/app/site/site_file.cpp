#include "app/site/site_file.h"

#include "app/site/site_models.h"
#include "drivers/registry.h"
#include "drivers/site/simulation.h"

#include "core/file.h"

#include <fmt/format.h>

#include <string>

namespace fantascope::app {
namespace {

class Drivers final : public show::DeviceReader {
public:
    Result<void> display(const show::Output& output) override {
        return shared(output.display,
                      drivers::readDisplay(output.display.options, {output.name, output.size(), output.refreshRate}));
    }
    Result<void> port(const show::DeviceConfig& device, int universe) override {
        return shared(device, drivers::readDmxPort(device.options, universe));
    }
    Result<void> desk(const show::DeviceConfig& device, int universe) override {
        return shared(device, drivers::readDmxSource(device.options, universe));
    }
    Result<void> relayBank(const show::Bank& bank, std::size_t size) override {
        return shared(bank.device, drivers::readRelayBank(bank.device.options, bank.name, std::vector<bool>(size)));
    }
    Result<void> contactBank(const show::Bank& bank, std::size_t size) override {
        return shared(bank.device, drivers::readInputBank(bank.device.options, bank.name, size));
    }
    Result<void> cueController(const show::DeviceConfig& device) override {
        return shared(device, drivers::readCueController(device.options));
    }
    Result<void> camera(const show::DeviceConfig& device) override { return shared(device, drivers::readCamera(device.options)); }
    Result<void> simulation(const show::Site& site) override {
        const auto nominal = simulationOf(site);
        if (!nominal) return site.simulation->error(nominal.error());
        TRY(site::readSimulation(*site.simulation, *nominal));
        return {};
    }

private:
    template <class Port>
    Result<void> shared(const show::DeviceConfig& device, const Result<drivers::Opening<Port>>& opening) {
        if (!opening) return opening.error();
        return uses_.add(device.options, opening->uses);
    }

    drivers::SharedUses uses_;
};

}  // namespace

Result<show::Site> readSite(const std::filesystem::path& fileOrFolder) {
    std::error_code ignored;
    const bool isFolder = std::filesystem::is_directory(fileOrFolder, ignored);
    Drivers drivers;
    show::Site site = TRY(show::readSite(isFolder ? fileOrFolder / "site.yaml" : fileOrFolder, &drivers));
    for (show::Output& output : site.outputs) output.projection.canvasAspect = canvasAspectOf(site, output.canvas);
    return site;
}

Result<std::filesystem::path> undoWrite(const std::filesystem::path& file) {
    std::error_code ignored;
    const std::filesystem::path site = std::filesystem::is_directory(file, ignored) ? file / "site.yaml" : file;
    std::filesystem::path previous = site;
    previous += ".previous";
    if (!std::filesystem::exists(previous, ignored))
        return Error(fmt::format("{}: there is nothing to go back to; the program keeps this file when it writes {}",
                                 previous.string(), site.string()));
    TRY(readSite(previous));
    TRY(exchangeFiles(site, previous));
    return site;
}

}  // namespace fantascope::app
