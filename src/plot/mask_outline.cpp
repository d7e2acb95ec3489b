#include "plot/mask_outline.h"

namespace fantascope::plot {

std::vector<std::vector<glm::dvec2>> maskOutline(const theatre::BitMask& mask) {
    std::vector<std::vector<glm::dvec2>> rings;
    // Every ring has a pixel side with white below and black above. It is started at one of them;
    // the others that it passes are marked as done.
    theatre::BitMask done(mask.width(), mask.height());
    for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width(); ++x) {
            if (!mask.at(x, y) || mask.at(x, y - 1) || done.at(x, y)) continue;
            // Follows the pixels' sides, with white on the right.
            std::vector<glm::dvec2> ring;
            const glm::ivec2 start(x, y);
            glm::ivec2 corner = start, ahead(1, 0);
            do {
                if (ahead == glm::ivec2(1, 0)) done.fill(corner.y, corner.x, corner.x + 1);
                ring.push_back(glm::dvec2(corner) + 0.5 * glm::dvec2(ahead));
                corner += ahead;
                const glm::ivec2 right(-ahead.y, ahead.x);
                // The two pixels beyond the corner, to its left and right.
                const auto isWhite = [&](const glm::ivec2& sideways) {
                    const glm::dvec2 centre = glm::dvec2(corner) + 0.5 * glm::dvec2(ahead) + 0.5 * glm::dvec2(sideways);
                    return mask.at(static_cast<int>(centre.x - 0.5), static_cast<int>(centre.y - 0.5));
                };
                if (!isWhite(right))
                    ahead = right;
                else if (isWhite(-right))
                    ahead = -right;
            } while (corner != start || ahead != glm::ivec2(1, 0));
            ring.push_back(ring.front());
            rings.push_back(std::move(ring));
        }
    return rings;
}

}  // namespace fantascope::plot
