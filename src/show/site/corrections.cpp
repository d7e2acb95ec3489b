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

}  // namespace

Result<Corrections> readCorrections(const ConfigNode& node) {
    Corrections corrections;
    ConfigFields fields(node);
    fields.optional().read("geometry", corrections.geometry, readGeometry);
    TRY(fields.finish());
    return corrections;
}

}  // namespace fantascope::show
