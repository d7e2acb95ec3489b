#include "render/picture_source.h"

#include <algorithm>
#include <cmath>

namespace fantascope::render {

Time positionAt(const VideoSource& source, Time time) {
    // Neither a display's refreshes nor a file's time stamps are exact: a frame that begins within so much is on.
    constexpr Time kTolerance = std::chrono::milliseconds(1);
    const Time length = source.stream->content().length;
    const Time played(std::llround(static_cast<double>((time + kTolerance).count()) * source.speed));
    if (source.loop) return (played % length + length) % length;
    return std::clamp(played, Time{}, length - Time(1));
}

}  // namespace fantascope::render
