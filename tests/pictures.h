#pragma once

#include "core/image.h"

namespace fantascope {

// Grey: 1 where it is white, else 0.
template <class IsWhite>
GreyImage pictureOf(int width, int height, IsWhite isWhite) {
    GreyImage picture(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) picture.at(x, y) = isWhite(x, y) ? 1.0f : 0.0f;
    return picture;
}

inline bool isIn(int x, int y, int left, int top, int width, int height) {
    return x >= left && x < left + width && y >= top && y < top + height;
}

}  // namespace fantascope
