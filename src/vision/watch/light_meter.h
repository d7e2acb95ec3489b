#pragma once

#include "vision/watch/usual_by_lamps.h"

#include "core/geometry.h"
#include "media/image.h"

#include <optional>
#include <vector>

namespace fantascope::vision {

// What a camera picture says of an output's light on the wall, compared with what is usual.
struct OutputLight {
    double contrast = 1;           // of the picture / its usual contrast; 0: the picture is not there
    double blur = 0;               // standard deviation of a Gaussian beside the usual blur, cells
    bool isCameraBlurred = false;  // the surface is blurred too, so the camera is what blurs
    double otherLight = 0;         // light that is not the picture's, beside the usual, as a share of full light
    double textured = 0;           // share of all other light that shows the surface's texture: a haze does not
    double allOtherLight = 0;      // all light that is not the picture's, as a share of full light
    double saturated = 0;          // share of its bright places where the camera is saturated
    double asUsual = 1;            // share of the picture that looks as usual
    double explained = 1;          // share of the picture that contrast and blur explain
    double hidden = 0;             // share of the picture that has not looked as usual for long
};

// The light of a frame at the places where the cells are: `light` is by cells of the frame, and
// what was at a place is shown at shownFromPlace. 0 beyond the frame.
GreyImage placedLight(const GreyImage& light, const Homography& shownFromPlace);

// Measures an output's light on the wall while the show runs: how strong and how sharp its picture
// is, and how much other light lies over it. The picture is divided into blocks. In a block, only
// what differs from its mean tells how strong and sharp the picture is, so smooth light of lamps
// does not matter. What is usual is learned from the first pictures. Thread: thread-bound.
class LightMeter {
public:
    // What the camera sees of an output, by cells (OutputView).
    struct Sight {
        const GreyImage& seen;     // the light that the camera gets, linear
        const GreyImage& surface;  // what it gets at full light; 0: the cell does not count
        const GreyImage& light;    // of the frame that is shown, 0..1
        const GreyImage& mask;     // 1 where `seen` is valid
        Homography shownFromPlace;
    };
    // `isFound`: the picture stands at shownFromPlace; only then it may count as usual. Nothing: it
    // has too little content, or what is usual is not known yet.
    std::optional<OutputLight> measure(const Sight& sight, bool isFound);
    // Other lamps change. In a new state, what they add from the last picture to the next ones
    // becomes usual. Nothing: they are changing.
    void lampsChange(const std::optional<LampState>& state);

private:
    struct Comparison;
    Comparison compare(const Sight& sight) const;
    void learn(const Comparison& now);
    OutputLight describe(const Comparison& now, const Sight& sight);

    struct Usual {
        int pictures = 0;  // from which it was learned
        double contrast = 0, blur = 0;
        std::vector<double> unexplained{};  // by block: as a share of the picture's variance; negative: unknown
    } usual_;
    std::vector<int> off_{};  // by block: how many measurements it has not looked as usual
    // Usual light that is not the picture's, as a share of full light.
    struct OtherLight {
        int pictures = 0;  // from which it was learned
        double light = 0;
    };
    UsualByLamps<OtherLight> usualOther_;
    double other_ = 0, keptOther_ = 0;  // beside the usual: now, and before the lamps changed
};

}  // namespace fantascope::vision
