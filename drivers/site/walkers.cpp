#include "drivers/site/walkers.h"

#include "drivers/site/limits.h"

#include <cmath>

namespace fantascope::site {

std::optional<Body> Walker::bodyAt(Time time) const {
    if (time < at) return std::nullopt;
    const double length = path.length();
    double distance = speed * seconds(time - at);
    if (!loop && distance > length) return std::nullopt;
    distance = std::fmod(distance, 2 * length);
    const bool returns = distance > length;
    const GroundPath::Place place = path.at(returns ? 2 * length - distance : distance);
    return Body::standing(place.position, returns ? -place.direction : place.direction, height, reflectance);
}

Result<Walker> readWalker(const ConfigNode& node) {
    Walker walker;
    ConfigFields fields(node);
    fields.text("name", walker.name);
    fields.optional().number("height", walker.height, 0.3, 3, "m");
    fields.optional().vector3("reflectance", walker.reflectance, 0, 1);
    fields.read("path", walker.path, GroundPath::read);
    fields.optional().number("speed", walker.speed, 0.01, 20, "m/s");
    fields.time("at", walker.at, 0, kMaxTime);
    fields.optional().boolean("loop", walker.loop);
    TRY(fields.finish());
    return walker;
}

}  // namespace fantascope::site
