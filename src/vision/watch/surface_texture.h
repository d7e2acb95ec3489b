#pragma once

#include "core/geometry.h"
#include "media/image.h"

#include <cstdint>

namespace fantascope::vision {

// How bright the surface is under a projector's full light, by cells (OutputView): its own texture,
// and the projector's fall-off. If it was not measured, it is learned from what the show lights
// well. Thread: thread-bound.
class SurfaceTexture {
public:
    // `full`: by cell, as measured, or the projector's own fall-off; 0: the camera does not see it.
    SurfaceTexture(const GreyImage& full, bool isMeasured);

    // By cell: the light at full light, as far as it is known; 0: the camera does not see it.
    const GreyImage& full() const { return filled_; }
    // What is seen of each cell as a share of its full light.
    GreyImage shareOf(const GreyImage& seen) const;
    // How much brighter the surface is, as a mean, than `full` says.
    double level() const { return level_; }
    // Learns from the light that is seen of each cell, while the frame's `light` shows at
    // shownFromPlace. `mask`: 1 where `seen` is valid.
    void learn(const GreyImage& seen, const GreyImage& light, const GreyImage& mask, const Homography& shownFromPlace);
    // Forgets what was learned.
    void forget();
    // Whether the surface is where it was learned, or moved along with the picture: by `moved`,
    // from cells to the cells where the picture came from. In standard deviations, positive: it is
    // where it was; 0: nothing is known. `gain`: of the picture's contrast.
    double stayed(const GreyImage& seen, const GreyImage& light, const GreyImage& mask, const Homography& shownFromPlace,
                  const Homography& moved, double gain) const;

private:
    void fill();

    GreyImage full_;     // as given
    GreyImage fallOff_;  // what is smooth in it: the projector's own
    bool isMeasured_;
    GreyImage known_;            // by cell: what was learned; 0: nothing yet
    Image<std::uint8_t> count_;  // by cell: from how many pictures
    GreyImage filled_;           // `known_`, and guesses from the neighbourhood elsewhere
    double level_ = 1;
    int sinceFilled_ = 0;
};

}  // namespace fantascope::vision
