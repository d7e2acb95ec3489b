#pragma once

#include "show/play/event.h"
#include "show/site/site.h"
#include "vision/watch/canvas_surface.h"

#include "core/fit.h"
#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace fantascope::app {

// What makes the light of one canvas even, by the site's survey (vision/light_compensation.h).
struct LightCorrection {
    std::string canvas;
    std::vector<std::size_t> outputs;                     // that show parts of it
    std::vector<std::shared_ptr<const GreyImage>> gains;  // of `outputs`: a factor for each projector pixel, linear light
    double kept = 1;                                      // share of a white canvas's light that is left
    double tooDark = 0, tooBright = 0;                    // shares of its places that stay darker, brighter than the others
    std::string trouble;                                  // why there is none, and what to do; empty: there is one
};

// The light corrections of all canvases, within the site file's bounds; none if it turns them off,
// or only asks for advice and there is no survey. Takes a second and more. Thread: reentrant.
std::vector<LightCorrection> lightCorrectionsOf(const show::Site& site);

// The factors of one output, or null.
std::shared_ptr<const GreyImage> gainOf(const std::vector<LightCorrection>& corrections, std::size_t output);

// By output: the factors, or null; all null unless the site file says that the light is corrected.
std::vector<std::shared_ptr<const GreyImage>> gainsToApply(const show::Site& site,
                                                           const std::vector<LightCorrection>& corrections);
// What the operator is told of them.
std::vector<show::event::LightCorrected> lightNewsOf(const show::Site& site, const std::vector<LightCorrection>& corrections);

// The light that a white shape gives at each place of a picture that lies on the canvas of an
// output as `fit` says, as the camera sees it; with the light correction if that is automatic.
// `aspect`: width / height of the picture. `size`: of the result, pixels. Linear; full light of the
// camera's picture is 1. Takes a second and more. Error: what the survey lacks, and what to do.
Result<vision::CanvasSurface> canvasSurface(const show::Site& site, std::size_t output, double aspect, Fit fit, glm::ivec2 size);

}  // namespace fantascope::app
