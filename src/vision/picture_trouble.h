#pragma once

#include "media/image.h"

namespace fantascope::vision {

// Why a camera's picture shows nothing: almost all of it is black, or most of it is white.
enum class PictureTrouble { None, Black, Saturated };
PictureTrouble troubleOf(const RgbaImage& picture);

}  // namespace fantascope::vision
