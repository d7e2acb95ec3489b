#pragma once

#include "theatre/mask/bit_mask.h"

#include "core/random.h"

#include <string_view>
#include <vector>

namespace fantascope::theatre {

// '#' is white.
inline BitMask maskOf(const std::vector<std::string_view>& rows) {
    BitMask mask(static_cast<int>(rows[0].size()), static_cast<int>(rows.size()));
    for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width(); ++x)
            if (rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)] == '#') mask.fill(y, x, x + 1);
    return mask;
}
inline BitMask randomMask(Rng& rng, int width, int height, double white) {
    BitMask mask(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            if (rng.uniform() < white) mask.fill(y, x, x + 1);
    return mask;
}
template <class IsWhite>
BitMask drawn(int width, int height, IsWhite isWhite) {
    BitMask mask(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            if (isWhite(x, y)) mask.fill(y, x, x + 1);
    return mask;
}

}  // namespace fantascope::theatre
