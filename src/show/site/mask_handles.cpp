#include "show/site/mask_handles.h"

#include <fmt/format.h>

namespace fantascope::show {

std::string pointOf(glm::dvec2 point) { return fmt::format("{:.2f}, {:.2f}", point.x, point.y); }

std::vector<MaskHandle> maskHandles(const std::vector<Mask>& masks) {
    std::vector<MaskHandle> handles;
    for (std::size_t mask = 0; mask < masks.size(); ++mask) {
        if (masks[mask].polygon.empty()) continue;
        for (std::size_t point = 0; point < masks[mask].polygon.size(); ++point)
            handles.push_back({MaskHandle::Kind::Point, mask, point});
        handles.push_back({MaskHandle::Kind::Whole, mask});
        handles.push_back({MaskHandle::Kind::Feather, mask});
    }
    return handles;
}

Result<MaskHandle> chosenOf(const std::vector<Mask>& masks, std::size_t handle) {
    const std::vector<MaskHandle> handles = maskHandles(masks);
    if (handles.empty()) return Error("there is no mask that can be moved; add one");
    return handles[handle];
}

EditHandle editHandle(const std::vector<Mask>& masks, const MaskHandle& handle) {
    const std::vector<glm::dvec2>& polygon = masks[handle.mask].polygon;
    switch (handle.kind) {
        case MaskHandle::Kind::Point:
            return {polygon[handle.point], fmt::format("{} | {}", handle.mask + 1, handle.point + 1)};
        case MaskHandle::Kind::Whole: {
            glm::dvec2 sum(0);
            for (const glm::dvec2 point : polygon) sum += point;
            return {sum / static_cast<double>(polygon.size()), fmt::format("mask {}", handle.mask + 1)};
        }
        case MaskHandle::Kind::Feather:
            break;
    }
    return {std::nullopt, fmt::format("feather of mask {}", handle.mask + 1)};
}

std::string valueText(const Mask& mask, const MaskHandle& handle) {
    if (handle.kind == MaskHandle::Kind::Point) return pointOf(mask.polygon[handle.point]);
    if (handle.kind == MaskHandle::Kind::Feather) return fmt::format("{:.2f}", mask.feather);
    return mask.hidesOutside ? "hides its outside" : "hides its inside";
}

}  // namespace fantascope::show
