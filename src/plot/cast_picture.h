#pragma once

#include "theatre/search/pose_search.h"

#include "plot/cast_figures.h"
#include "plot/stage_view.h"

#include <span>
#include <string>
#include <vector>

namespace fantascope::plot {

// The data of a cast's figures, from poses of a problem with skins.
struct CastPicture {
    // A beam's image on its screen.
    struct Image {
        // Each actor's notes say how he stands. A last entry is for all platforms and props, if
        // there are any.
        std::vector<ActorShadow> actors;
        theatre::BitMask target;
        std::vector<std::string> lines;  // how well the shadow fits, and whether everyone can stand like that
    };
    StageView view;
    std::vector<Image> images;  // one per beam

    // The shadowFigure(), or the actorsFigure(), of all beams below each other.
    Page shadows() const;
    Page each() const;
};

// `dofs`: all actors' degrees of freedom, one actor after the other.
CastPicture castPicture(const theatre::PoseProblem& problem, std::span<const double> dofs);

}  // namespace fantascope::plot
