#include "show/site/corrections.h"

#include "show/site/light_channels.h"
#include "show/site/site.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <string>

namespace fantascope::show {
namespace {

Result<Corrections::Geometry> readGeometry(const ConfigNode& node) {
    Corrections::Geometry geometry;
    ConfigFields fields(node);
    fields.optional().choice("mode", geometry.mode, {"off", "advise", "automatic"});
    fields.optional().number("farthest", geometry.farthest, 0, 1000);
    fields.optional().number("speed", geometry.speed, 0.1, 1000);
    TRY(fields.finish());
    return geometry;
}

Result<Corrections::Light> readLight(const ConfigNode& node) {
    Corrections::Light light;
    ConfigFields fields(node);
    fields.optional().choice("mode", light.mode, {"off", "advise", "automatic"});
    fields.optional().number("least", light.least, 0.05, 1);
    fields.optional().number("clipped", light.clipped, 0, 0.5);
    TRY(fields.finish());
    return light;
}

Result<Corrections::Pattern> readPattern(const ConfigNode& node) {
    Corrections::Pattern pattern;
    ConfigFields fields(node);
    fields.optional().choice("mode", pattern.mode, {"off", "advise", "automatic"});
    fields.optional().number("gain", pattern.gain, 0.05, 0.9);
    fields.optional().number("more", pattern.more, 0, 4);
    fields.optional().number("least", pattern.least, 0.05, 1);
    fields.optional().number("fade", pattern.fade, 0.5, 60);
    TRY(fields.finish());
    return pattern;
}

// Reads a name of `things` as its index. Each may be named once.
Result<std::size_t> readIndex(const ConfigNode& node, const auto& things, const char* kind, std::set<std::size_t>& taken) {
    const std::string name = TRY(node.text());
    std::vector<std::string> names;
    for (const auto& thing : things) names.push_back(thing.name);
    const auto found = std::ranges::find(names, name);
    if (found == names.end())
        return node.error(fmt::format("there is no {} '{}'{}", kind, name, names.empty() ? "" : "; there are " + listed(names)));
    const auto index = static_cast<std::size_t>(found - names.begin());
    if (!taken.insert(index).second) return node.error(fmt::format("{} '{}' is named twice", kind, name));
    return index;
}

Result<Corrections::Lamps> readLamps(const ConfigNode& node, const Site& site, bool isRight) {
    Corrections::Lamps lamps;
    std::set<std::size_t> fixtures, relays;
    ConfigFields fields(node);
    fields.optional().choice("mode", lamps.mode, {"off", "advise", "automatic"});
    fields.optional().list("fixtures", lamps.fixtures, [&](const ConfigNode& name) -> Result<std::size_t> {
        if (!isRight) return 0;
        const std::size_t index = TRY(readIndex(name, site.fixtures, "fixture", fixtures));
        const Fixture& fixture = site.fixtures[index];
        for (std::size_t channel = 0; channel < fixture.channels.size(); ++channel)
            if (scalesLight(fixture, channel)) return index;
        return name.error(
            fmt::format("fixture '{}' has neither a channel 'intensity' nor colours, so it cannot be dimmed", fixture.name));
    });
    fields.optional().list("relays", lamps.relays, [&](const ConfigNode& name) -> Result<std::size_t> {
        if (!isRight) return 0;
        return readIndex(name, site.relays, "relay", relays);
    });
    fields.optional().number("least", lamps.least, 0, 1);
    // At 0.05 a level moves by a third of a slot's step of 1/255 from one DMX frame to the next.
    fields.optional().number("speed", lamps.speed, 0.001, 0.05);
    fields.optional().time("hold", lamps.hold, 10, 86400);
    TRY(fields.finish());
    return lamps;
}

}  // namespace

Result<Corrections> readCorrections(const ConfigNode& node, const Site& site, bool isRight) {
    Corrections corrections;
    ConfigFields fields(node);
    fields.optional().read("geometry", corrections.geometry, readGeometry);
    fields.optional().read("light", corrections.light, readLight);
    fields.optional().read("pattern", corrections.pattern, readPattern);
    fields.optional().read("lamps", corrections.lamps, [&](const ConfigNode& lamps) -> Result<Corrections::Lamps> {
        Corrections::Lamps read = TRY(readLamps(lamps, site, isRight));
        if (corrections.geometry.mode == Corrections::Mode::Off && read.mode != Corrections::Mode::Off && read.any())
            return lamps.error("needs the watch of the wall: set the mode of 'geometry' to advise or automatic");
        return read;
    });
    TRY(fields.finish());
    return corrections;
}

}  // namespace fantascope::show
