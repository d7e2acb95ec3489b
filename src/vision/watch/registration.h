#pragma once

#include "core/geometry.h"
#include "media/image.h"

#include <optional>

namespace fantascope::vision {

// How a seen picture lies on an expected one.
struct Registration {
    Homography expectedFromSeen;  // pixels: `seen` at q shows what is expected at expectedFromSeen(q)
    double sigma = 0;             // standard deviation of expectedFromSeen, rms where there is content, pixels
    double gain = 0;              // contrast of what is seen / contrast of what is expected
    double agreement = 0;         // correlation of the two pictures where they agree at all, -1..1
    double used = 0;              // share of the pixels with content that agree
};

enum class SearchRange {
    Near,  // the movement differs from the start by about a pixel
    Wide   // it differs by up to a tenth of the picture's width
};

// Registers two pictures of one size that differ by a small projective movement (Lucas & Kanade
// 1981; Baker & Matthews 2004), from coarse to fine. Only what differs from its neighbourhood is
// compared, so smooth light of other lamps, and fog, hardly matter. Things in front of the picture
// do not matter, because pixels that differ much more than most have no weight (Tukey's biweight).
//
// `mask`: 1 where `seen` is valid, 0 elsewhere. `start`: a guess.
// Nothing: the pictures have too little content, or do not agree anywhere. Thread: reentrant.
std::optional<Registration> registerPictures(const GreyImage& seen, const GreyImage& expected, const GreyImage& mask,
                                             const Homography& start, SearchRange range);

// rms over the points of a rectangle of how far a map moves them, pixels.
double rmsMovement(const Homography& map, glm::dvec2 low, glm::dvec2 high);

}  // namespace fantascope::vision
