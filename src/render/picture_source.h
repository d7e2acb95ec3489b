#pragma once

#include "pattern/pattern_motion.h"
#include "pattern/shape_pattern.h"

#include <glm/vec3.hpp>

#include <memory>
#include <variant>

namespace fantascope::render {

// A light pattern; shared by the outputs that show it.
struct PatternSource {
    std::shared_ptr<const pattern::ShapePattern> pattern;
    std::shared_ptr<const pattern::PatternMotion> motion;  // null: the shapes rest
};

// The whole canvas in one colour.
struct SolidSource {
    glm::vec3 colour{1};  // linear light, 0..1
};

// What a layer can show, in the order of Show::sources.
using PictureSource = std::variant<PatternSource, SolidSource>;

}  // namespace fantascope::render
