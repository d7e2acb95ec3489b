#include "show/site/corrections.h"

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

}  // namespace

Result<Corrections> readCorrections(const ConfigNode& node) {
    Corrections corrections;
    ConfigFields fields(node);
    fields.optional().read("geometry", corrections.geometry, readGeometry);
    fields.optional().read("light", corrections.light, readLight);
    fields.optional().read("pattern", corrections.pattern, readPattern);
    TRY(fields.finish());
    return corrections;
}

}  // namespace fantascope::show
