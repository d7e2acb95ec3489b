#pragma once

#include "theatre/energy/pose_problem.h"
#include "theatre/mask/bit_mask.h"

#include <cstddef>
#include <span>
#include <vector>

namespace fantascope::theatre {

// Properties of a moving silhouette that are known before any poses follow it. Masks are of one
// size, one for each frame, each with at least one white pixel.
// Thread: reentrant.

// For each frame, the minimum intersection over union with any other frame. Principal poses of the
// frame with the greatest value have the shortest way to all others. If there are many frames, each
// is compared with about kLooks of them.
std::vector<double> leastOverlaps(std::span<const BitMask> frames);
constexpr std::size_t kLooks = 64;

// middleFrame() gives the frame with the greatest value. isOffTheMiddle() says whether that value
// exceeds that of `frame` by kNearer, so that the middle frame's poses are likely to follow better.
std::size_t middleFrame(std::span<const double> leastOverlaps);
bool isOffTheMiddle(std::size_t frame, std::span<const double> leastOverlaps);
constexpr double kNearer = 0.05;

// The intersection over union of two targets on one stage. Each has its own ScreenFrame, whose
// middle is straight in front of the light.
double overlap(const PoseTarget& a, const PoseTarget& b);

// The frame of a sequence that is most like a target, to which the target's poses belong.
struct Likeness {
    std::size_t frame = 0;
    double overlap = 0;
    bool isEnough() const { return overlap >= kAlike; }
    static constexpr double kAlike = 0.9;
};
Likeness mostAlike(std::span<const PoseTarget> frames, const PoseTarget& wanted);

// Two successive frames that overlap so little that poses of one hardly help to find those of the
// other.
struct Jump {
    std::size_t from = 0, to = 0;
    double overlap = 0;  // intersection over union, less than kJump
};
constexpr double kJump = 0.5;
std::vector<Jump> jumpsOf(std::span<const BitMask> frames, bool loops);

}  // namespace fantascope::theatre
