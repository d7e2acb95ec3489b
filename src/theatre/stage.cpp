#include "theatre/stage.h"

namespace fantascope::theatre {

ScreenFrame::ScreenFrame(const Stage& stage, double left, double top, double pixel, int width, int height)
    : light_(stage.light),
      left_(left),
      top_(top),
      pixel_(pixel),
      width_(width),
      height_(height),
      foot_(pixelAt(light_.x, light_.y)),
      focus_(light_.z / pixel) {}

}  // namespace fantascope::theatre
