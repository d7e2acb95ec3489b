#pragma once

#include "core/result.h"
#include "media/projection.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::show {

// Something that can be moved.
struct EditHandle {
    std::optional<glm::dvec2> at;  // projector pixels, for what has a place there
    std::string label;
};

// What can be moved of the masks. Images are the file's alone.
struct MaskHandle {
    enum class Kind { Point, Whole, Feather };
    Kind kind = Kind::Point;
    std::size_t mask = 0, point = 0;
};

// Of all masks, in their order: the points of one, the whole of it, its feather.
std::vector<MaskHandle> maskHandles(const std::vector<Mask>& masks);

// The one that a handle belongs to. Error: there is none.
Result<MaskHandle> chosenOf(const std::vector<Mask>& masks, std::size_t handle);

EditHandle editHandle(const std::vector<Mask>& masks, const MaskHandle& handle);

// What it is now, in words.
std::string valueText(const Mask& mask, const MaskHandle& handle);

// "12.50, 3.00"
std::string pointOf(glm::dvec2 point);

}  // namespace fantascope::show
