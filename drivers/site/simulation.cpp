#include "drivers/site/simulation.h"

#include "drivers/site/limits.h"
#include "drivers/site/objects.h"

#include <fmt/format.h>

#include <algorithm>

namespace fantascope::site {
namespace {

Result<SimulatedProjector> readProjector(const ConfigNode& node) {
    SimulatedProjector projector;
    ConfigFields fields(node);
    fields.optional().number("lumens", projector.lumens, 0, kMaxLight, "lm");
    fields.optional().number("black_level", projector.blackLevel, 0, 1);
    fields.optional().number("gamma", projector.gamma, 0.5, 5);
    fields.optional().vector3("white", projector.white, 0, 1);
    TRY(fields.finish());
    return projector;
}

Result<SimulatedCamera> readCamera(const ConfigNode& node) {
    SimulatedCamera camera;
    ConfigFields fields(node);
    fields.optional().number("white", camera.sensor.white, 1e-3, kMaxLight, "cd/m2");
    fields.optional().number("read_noise", camera.sensor.readNoise, 0, 1);
    fields.optional().number("shot_noise", camera.sensor.shotNoise, 0, 1);
    fields.optional().time("latency", camera.latency, 0, 10);
    fields.optional().number("frame_rate", camera.frameRate, 0.01, 240, "Hz");
    fields.optional().number("vignetting", camera.vignetting, 0, 1);
    fields.optional().number("blur", camera.blur, 0, 20, "pixels");
    fields.optional().time("rolling", camera.rolling, 0, 1);
    TRY(fields.finish());
    if (camera.rolling >= tickTime(1, camera.frameRate))
        return node.error(fmt::format("'rolling' must be shorter than a frame's period, here {} s", 1 / camera.frameRate));
    return camera;
}

template <class Named>
std::vector<std::string> namesOf(const std::vector<Named>& things) {
    std::vector<std::string> names;
    for (const Named& thing : things) names.push_back(thing.name);
    return names;
}

// Reads a map from names that the site declares to what the simulation adds; calls use(index of the
// name, value).
template <class Parse, class Use>
Result<void> readNamed(const ConfigNode& node, const std::vector<std::string>& names, std::string_view kind, Parse parse,
                       Use use) {
    ConfigFaults faults;
    for (const auto& [name, value] : TRY(node.entries())) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end()) {
            const std::string nearest = nearestName(name, names);
            faults.add(value.error(fmt::format("this site has no {} '{}' ({})", kind, name,
                                               !nearest.empty() ? fmt::format("did you mean '{}'?", nearest)
                                               : names.empty()  ? fmt::format("it declares no {}", kind)
                                                                : fmt::format("known here: {}", fmt::join(names, ", ")))));
            continue;
        }
        faults.take(parse(value), [&](auto read) { use(static_cast<std::size_t>(found - names.begin()), std::move(read)); });
    }
    return faults.result();
}

Result<std::vector<SimulatedProjector>> readProjectors(const ConfigNode& node, const NominalSite& nominal) {
    std::vector<SimulatedProjector> projectors(nominal.outputs.size());
    TRY(readNamed(node, namesOf(nominal.outputs), "output", readProjector,
                  [&](std::size_t output, SimulatedProjector projector) { projectors[output] = projector; }));
    return projectors;
}

Result<std::vector<FedLamp>> readLamps(const ConfigNode& node, const std::vector<std::string>& feeds, std::string_view kind) {
    std::vector<FedLamp> lamps;
    TRY(readNamed(node, feeds, kind, readLamp, [&](std::size_t feed, const Lamp& lamp) { lamps.push_back({feed, lamp}); }));
    return lamps;
}

Result<Closing> readClosing(const ConfigNode& node, const std::vector<std::string>& contacts) {
    Closing closing;
    const Span span{closing.at, closing.until};
    ConfigFields fields(node);
    fields.read("contact", closing.contact, [&](const ConfigNode& value) { return value.choice(contacts); });
    span.declare(fields);
    TRY(fields.finish());
    TRY(span.check(node));
    return closing;
}

}  // namespace

Result<Simulation> readSimulation(const ConfigNode& node, const NominalSite& nominal) {
    Simulation simulation;
    simulation.projectors.resize(nominal.outputs.size());
    ConfigFields fields(node);
    fields.optional().vector3("ambient", simulation.ambient, 0, kMaxLight, "lux");
    fields.optional().vector3("sky", simulation.sky, 0, kMaxLight, "cd/m2");
    fields.list("objects", simulation.objects, readObject, 1);
    fields.optional().read("projectors", simulation.projectors,
                           [&](const ConfigNode& value) { return readProjectors(value, nominal); });
    fields.optional().read("lamps", simulation.lamps,
                           [&](const ConfigNode& value) { return readLamps(value, namesOf(nominal.fixtures), "fixture"); });
    fields.optional().read("street_lamps", simulation.streetLamps,
                           [&](const ConfigNode& value) { return readLamps(value, namesOf(nominal.relays), "relay"); });
    fields.optional().read("camera", simulation.camera, readCamera);
    fields.optional().list("walkers", simulation.walkers, readWalker);
    fields.optional().list("headlights", simulation.headlights, readHeadlight);
    fields.optional().list("contacts", simulation.closings,
                           [&](const ConfigNode& value) { return readClosing(value, namesOf(nominal.contacts)); });
    fields.optional().list("faults", simulation.faults, [&](const ConfigNode& value) { return readFault(value, nominal); });
    for (const NominalSite::Output& output : nominal.outputs)
        if (const glm::ivec2 size = output.projector.size; std::min(size.x, size.y) < ProjectedLight::kMinSide)
            fields.check(node,
                         node.error(fmt::format("output '{}' of {} x {} pixels cannot be simulated; each side needs at least {}",
                                                output.name, size.x, size.y, ProjectedLight::kMinSide)));
    TRY(fields.finish());
    return simulation;
}

}  // namespace fantascope::site
