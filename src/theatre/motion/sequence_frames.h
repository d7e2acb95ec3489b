#pragma once

#include "theatre/energy/pose_problem.h"
#include "theatre/mask/bit_mask.h"

#include <cstddef>
#include <span>
#include <vector>

namespace fantascope::theatre {

// What can be said of a silhouette that moves before anybody follows it. Masks of one size, one a
// frame, each with something white.
// Thread: reentrant.

// Of each frame the least intersection over union with any other: principal poses of the frame with
// the greatest have the shortest way to all. Of many frames some kLooks are compared with.
std::vector<double> leastOverlaps(std::span<const BitMask> frames);
constexpr std::size_t kLooks = 64;

// Of those the frame with the greatest; and whether it is so much greater than that of `frame` that
// poses for it are likely to follow better.
std::size_t middleFrame(std::span<const double> leastOverlaps);
bool isOffTheMiddle(std::size_t frame, std::span<const double> leastOverlaps);
constexpr double kNearer = 0.05;

// The intersection over union of two targets on one stage, each in a frame of its own whose middle
// is before the light.
double overlap(const PoseTarget& a, const PoseTarget& b);

// The frame that poses for a target are of: the one most like it.
struct Likeness {
    std::size_t frame = 0;
    double overlap = 0;
    bool isEnough() const { return overlap >= kAlike; }
    static constexpr double kAlike = 0.9;
};
Likeness mostAlike(std::span<const PoseTarget> frames, const PoseTarget& wanted);

// From one frame to the next so little stays where it is that poses of the one say little of the
// other.
struct Jump {
    std::size_t from = 0, to = 0;
    double overlap = 0;  // intersection over union, less than kJump
};
constexpr double kJump = 0.5;
std::vector<Jump> jumpsOf(std::span<const BitMask> frames, bool loops);

}  // namespace fantascope::theatre
