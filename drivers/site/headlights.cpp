#include "drivers/site/headlights.h"

#include "drivers/site/limits.h"

#include <fmt/format.h>

namespace fantascope::site {

std::optional<Lamp> Headlight::lampAt(Time time) const {
    if (time < at) return std::nullopt;
    const Time since = every ? (time - at) % *every : time - at;
    const double distance = speed * seconds(since);
    if (distance > path.length()) return std::nullopt;
    const GroundPath::Place place = path.at(distance);
    Lamp moved = lamp;
    moved.position = place.position + glm::dvec3(0, height, 0);
    moved.aim = place.direction;
    return moved;
}

Result<Headlight> readHeadlight(const ConfigNode& node) {
    Headlight headlight;
    headlight.lamp.candela = 15000;
    ConfigFields fields(node);
    fields.read("path", headlight.path, GroundPath::read);
    fields.number("speed", headlight.speed, 0.01, 100, "m/s");
    fields.optional().number("height", headlight.height, 0, 100, "m");
    fields.time("at", headlight.at, 0, kMaxTime);
    fields.optional().read("every", headlight.every, [](const ConfigNode& value) -> Result<Time> {
        return fromSeconds(TRY(value.number(0.1, kMaxTime, "s")));
    });
    fields.optional().number("candela", headlight.lamp.candela, 0, kMaxLight, "cd");
    declareBeam(fields, headlight.lamp);
    TRY(fields.finish());
    TRY(checkBeam(headlight.lamp, node));
    if (headlight.every && seconds(*headlight.every) < headlight.duration())
        return node.error(fmt::format("'every' is shorter than the pass, which takes {} s; give each lamp an entry of its own",
                                      headlight.duration()));
    return headlight;
}

}  // namespace fantascope::site
