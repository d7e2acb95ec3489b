#pragma once

#include "app/base/report.h"
#include "app/lens/board_watch.h"

#include "vision/lens_fit.h"

#include "core/result.h"

#include <string>
#include <vector>

namespace fantascope::app {

// A lens, and whether it may be used.
struct LensResult {
    vision::LensFit fit;
    vision::LensNeeds needs;
    std::string trouble;  // why it is not good enough, and what to do; empty: it is good
    int views = 0;        // that count
    int leftOut = 0;      // that did not fit

    bool isGood() const { return trouble.empty(); }
    // "rms 0.12 px over 22 views (871 corners); field of view 61.23 degrees, ...".
    std::string sentence() const;
    Report report() const;
};

// The lens of these views. `missed`: pictures without a board; `leftOut`: views that were thrown
// away before.
// Error: no board in any picture, fewer than vision::kFewestFitted views, or no lens fits; each
// says what to do.
Result<LensResult> lensOf(const std::vector<vision::BoardView>& views, const Missed& missed, int leftOut = 0);

}  // namespace fantascope::app
