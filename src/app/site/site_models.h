#pragma once
// The site file's numbers as the models of those who see: the simulated site, and the comparison
// with the guide.

#include "drivers/site/simulated_site.h"

#include "render/canvas/blend_map.h"
#include "show/site.h"
#include "vision/guide_comparison.h"

#include "core/fit.h"
#include "core/result.h"

namespace fantascope::app {

// The index of an output. Error: the site has none of this name; says which one was perhaps meant.
Result<std::size_t> outputNamed(const show::Site& site, const std::string& name);

// What an output gives to each pixel beside the others on its canvas; null where it gives all of
// its light.
std::shared_ptr<const render::BlendMap> blendOf(const show::Site& site, std::size_t output);

// Error: the site lacks a projector's place, the camera or a usable optic; names what to add to the
// site file.
Result<site::NominalSite> simulationOf(const show::Site& site);

// Width / height of a canvas in the projectors' pixels: the mean over its outputs.
double canvasAspectInPixels(const show::Site& site, const std::string& canvas);
// Width / height of a canvas on the wall, or 0 if unknown. In this order: its `canvas_size`; in
// metres, if the site gives all its projectors and their surfaces; in pixels, if every output's
// corners form a rectangle. Keystoned corners alone do not tell the shape on the wall.
double canvasAspectOf(const show::Site& site, const std::string& canvas);

// What the comparison may know of one output for a picture of this aspect (width / height), which
// lies on the canvas as `fit` says. Nothing where the site does not say where the projector, its
// surface or the camera are: then the output is not scored.
Result<std::optional<vision::NominalView>> nominalViewOf(const show::Site& site, std::size_t output, double pictureAspect,
                                                         Fit fit);

}  // namespace fantascope::app
