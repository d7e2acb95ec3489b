#pragma once

#include "vision/camera_model.h"
#include "vision/lens_board.h"

#include "core/result.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <string>
#include <vector>

namespace fantascope::vision {

// A camera's lens as views of the board tell it.
struct LensFit {
    CameraModel lens;  // its pose is the identity
    double rms = 0;    // pixels, between corners as seen and as the lens draws them, over what was used
    // Standard deviation, pixels, of where the lens draws a direction; the largest in the picture.
    // It follows from the residuals and from what the views hold. Views without tilt leave it large
    // however small `rms` is. A turn of all directions is left out: where the camera looks is no
    // part of its lens, and a long lens cannot tell its centre from such a turn.
    double uncertainty = 0;
    int points = 0;  // corners that were used
    struct View {
        bool used = false;  // false: it does not fit the others
        double rms = 0;     // pixels
        // The board's normal, away from the camera, in camera axes (x right, y down, z forward);
        // unit.
        glm::dvec3 normal{0, 0, 1};
    };
    std::vector<View> views;  // by the views that were given

    int usedViews() const;
};

// The fewest views that are fitted, and the fewest for a result.
constexpr int kFewestFitted = 3, kFewestViews = 8;

// The lens that draws the board's corners where the views show them, by least squares (Zhang 2000),
// with the distortion of CameraModel. Views, and single corners, that lie far off are left out: a
// moved board, a finger on a corner. k2, and then k1, is 0 where the views tell so little of it
// that it leaves -1 .. 1. All views have one size. Deterministic; takes some 100 ms.
// Error: fewer than kFewestFitted views; no lens fits.
Result<LensFit> fitLens(const std::vector<BoardView>& views);

// The uncertainty that is good enough for a picture of this size, pixels.
constexpr double goodUncertainty(glm::ivec2 size) { return 0.75e-3 * size.x; }

// What the views still lack for a good lens.
struct LensNeeds {
    int views = 0;  // so many more
    // Parts of the picture where no corner was seen, of kParts across and down: "top left".
    std::vector<std::string> places;
    // Which way the board was not tilted yet by kLeastTilt: "its left edge".
    std::vector<std::string> tilts;
    bool isUncertain = false;  // the lens is not known well enough

    bool none() const { return views == 0 && places.empty() && tilts.empty() && !isUncertain; }
    // The same for a person who holds the board, at most one step of each kind: "hold it at the top
    // left of the picture; turn its left edge towards the camera". Empty: nothing is missing.
    std::string sentence() const;
};
constexpr glm::ivec2 kParts{3, 3};
constexpr double kLeastTilt = 15;  // degrees
constexpr int kEnoughViews = 15;

// `fit` is that of `views`; null: there is none yet.
LensNeeds needsOf(const std::vector<BoardView>& views, const LensFit* fit);

}  // namespace fantascope::vision
