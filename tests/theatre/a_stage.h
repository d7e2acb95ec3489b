#pragma once

#include "theatre/stage/stage.h"

#include <optional>

namespace fantascope::theatre {

// One light in front of a flat screen: a lamp, or a projector's lens that lights an area.
inline Stage aStage(const glm::dvec3& light, std::optional<Stage::Area> lit = std::nullopt) {
    Stage stage;
    stage.beams[0].light = light;
    stage.beams[0].lit = lit;
    return stage;
}

}  // namespace fantascope::theatre
