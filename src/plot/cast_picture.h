#pragma once

#include "theatre/search/pose_search.h"

#include "plot/cast_figures.h"
#include "plot/stage_view.h"

#include <span>
#include <string>
#include <vector>

namespace fantascope::plot {

// Poses of a problem with skins as the figures of a cast take them.
struct CastPicture {
    // What is on a beam's screen, as it looks there.
    struct Image {
        std::vector<ActorShadow>
            actors;  // how each stands in his notes; after them, if there are any, all platforms and props as one
        theatre::BitMask target;
        std::vector<std::string> lines;  // how well the shadow fits, and whether everyone can stand so
    };
    StageView view;
    std::vector<Image> images;  // of each beam

    // shadowFigure() and actorsFigure() of each beam, below each other.
    Page shadows() const;
    Page each() const;
};

// `dofs`: of all actors, one after the other.
CastPicture castPicture(const theatre::PoseProblem& problem, std::span<const double> dofs);

}  // namespace fantascope::plot
