#pragma once

#include "core/result.h"
#include "media/projection.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::show {

// Something that the editor can move.
struct EditHandle {
    std::optional<glm::dvec2> at;  // projector pixels; none: the handle has no place on the picture
    std::string label;
};

// A handle of a mask. Masks that are images have none: only the file changes them.
struct MaskHandle {
    enum class Kind { Point, Whole, Feather };
    Kind kind = Kind::Point;
    std::size_t mask = 0, point = 0;
};

// The handles of all masks, mask by mask: its points, the whole mask, its feather.
std::vector<MaskHandle> maskHandles(const std::vector<Mask>& masks);

// The mask handle with the index `handle`. Error: no mask can be moved.
Result<MaskHandle> chosenOf(const std::vector<Mask>& masks, std::size_t handle);

EditHandle editHandle(const std::vector<Mask>& masks, const MaskHandle& handle);

// The handle's present value, in words.
std::string valueText(const Mask& mask, const MaskHandle& handle);

// "12.50, 3.00"
std::string pointOf(glm::dvec2 point);

}  // namespace fantascope::show
