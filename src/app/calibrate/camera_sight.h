#pragma once

#include "device/camera_source.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace fantascope::app {

// What a camera's pictures have in common. It tells a camera that can see nothing from one that
// looks elsewhere. Thread: one at a time.
class CameraSight {
public:
    // Takes a picture into account. All have one size.
    void see(const std::shared_ptr<const CameraFrame>& frame);
    // The pictures before count no more.
    void clear() { *this = CameraSight(); }

    // Whether every picture has the same bytes. Those of a camera that works never have, because of
    // its noise.
    bool repeatsOne() const { return pictures_ >= kFewest && same_ == pictures_; }
    bool isBlack() const { return pictures_ >= kFewest && black_ == pictures_; }
    // Why nothing can be seen on the pictures, and what to do; empty: it can, or there are too few
    // to tell.
    std::string trouble() const;

private:
    static constexpr std::size_t kFewest = 4;

    std::shared_ptr<const CameraFrame> first_;
    std::size_t pictures_ = 0, same_ = 0, black_ = 0, white_ = 0;
};

// Notices a camera that goes on with one picture while others are shown. Thread: one at a time.
class FrozenCamera {
public:
    // `shown`: the number of the picture that is shown on the frame.
    void see(const std::shared_ptr<const CameraFrame>& frame, std::int64_t shown);
    // Whether so many shown pictures, one after the other, looked the same to the last byte.
    bool wasFrozen() const { return longest_ >= kFewest; }

private:
    static constexpr int kFewest = 4;

    std::shared_ptr<const CameraFrame> last_;
    std::int64_t shown_ = -1;
    int run_ = 0, longest_ = 0;
};

// That the camera is saturated or frozen, and what to do.
inline constexpr std::string_view kCameraWhite =
    "the camera's pictures are white, even while the outputs are dark; lower its exposure or gain, or wait until it is darker";
inline constexpr std::string_view kCameraFrozen = "the camera repeats one picture again and again; unplug it, and plug it in again";

}  // namespace fantascope::app
