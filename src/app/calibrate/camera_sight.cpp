#include "app/calibrate/camera_sight.h"

#include "vision/picture_trouble.h"

#include <algorithm>

namespace fantascope::app {

void CameraSight::see(const std::shared_ptr<const CameraFrame>& frame) {
    if (!first_) first_ = frame;
    const vision::PictureTrouble trouble = vision::troubleOf(frame->image);
    ++pictures_;
    same_ += std::ranges::equal(frame->image.pixels(), first_->image.pixels());
    black_ += trouble == vision::PictureTrouble::Black;
    white_ += trouble == vision::PictureTrouble::Saturated;
}

std::string CameraSight::trouble() const {
    if (pictures_ < kFewest) return "";
    if (isBlack())
        return std::string(
                   "the camera's pictures are black; take the cap off its lens, turn it towards the light, or raise its "
                   "exposure") +
               (repeatsOne() ? ". If that does not help, unplug it, and plug it in again" : "");
    if (white_ == pictures_) return std::string(kCameraWhite);
    return repeatsOne() ? std::string(kCameraFrozen) : "";
}

void FrozenCamera::see(const std::shared_ptr<const CameraFrame>& frame, std::int64_t shown) {
    if (last_ && !std::ranges::equal(frame->image.pixels(), last_->image.pixels()))
        run_ = 1;
    else
        run_ += shown != shown_;
    longest_ = std::max(longest_, run_);
    last_ = frame;
    shown_ = shown;
}

}  // namespace fantascope::app
