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

double overlap(const PoseTarget& a, const PoseTarget& b) {
    const int shift = (a.mask.width() - b.mask.width()) / 2, up = a.mask.height() - b.mask.height();
    std::int64_t both = 0;
    for (int y = 0; y < a.mask.height(); ++y)
        for (int x = 0; x < a.mask.width(); ++x) {
            const glm::ivec2 other(x - shift, y - up);
            const bool isInside = other.x >= 0 && other.y >= 0 && other.x < b.mask.width() && other.y < b.mask.height();
            both += a.mask.at(x, y) && isInside && b.mask.at(other.x, other.y);
        }
    return static_cast<double>(both) / (a.area + b.area - static_cast<double>(both));
}

Likeness mostAlike(std::span<const PoseTarget> frames, const PoseTarget& wanted) {
    Likeness best{0, -1};
    for (std::size_t i = 0; i < frames.size(); ++i)
        if (const double alike = overlap(frames[i], wanted); alike > best.overlap) best = {i, alike};
    return best;
}

}  // namespace fantascope::theatre
