#include "theatre/motion/sequence_frames.h"

#include <algorithm>

namespace fantascope::theatre {

std::vector<double> leastOverlaps(std::span<const BitMask> frames) {
    const std::size_t step = (frames.size() + kLooks - 1) / kLooks;
    std::vector<double> least(frames.size(), 1);
    for (std::size_t i = 0; i < frames.size(); ++i)
        for (std::size_t j = 0; j < frames.size(); j += step)
            least[i] = std::min(least[i], intersectionOverUnion(frames[i], frames[j]));
    return least;
}

std::size_t middleFrame(std::span<const double> leastOverlaps) {
    return static_cast<std::size_t>(std::max_element(leastOverlaps.begin(), leastOverlaps.end()) - leastOverlaps.begin());
}

bool isOffTheMiddle(std::size_t frame, std::span<const double> leastOverlaps) {
    return leastOverlaps[middleFrame(leastOverlaps)] > leastOverlaps[frame] + kNearer;
}

std::vector<Jump> jumpsOf(std::span<const BitMask> frames, bool loops) {
    std::vector<Jump> jumps;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        const std::size_t next = i + 1 < frames.size() ? i + 1 : 0;
        if (next == 0 && !loops) break;
        if (const double overlap = intersectionOverUnion(frames[i], frames[next]); overlap < kJump)
            jumps.push_back({i, next, overlap});
    }
    return jumps;
}

}  // namespace fantascope::theatre
