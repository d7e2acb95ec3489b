#pragma once
// From the site file's numbers to models: of the simulated site, and of the comparison with the
// guide.

#include "drivers/site/simulated_site.h"

#include "render/canvas/blend_map.h"
#include "show/site/site.h"
#include "vision/camera_light.h"
#include "vision/nominal_view.h"
#include "vision/watch/wall_watch.h"

#include "core/fit.h"
#include "core/result.h"

namespace fantascope::app {

// The index of an output. Error: the site has none of this name; it suggests a similar one.
Result<std::size_t> outputNamed(const show::Site& site, const std::string& name);

// The site's camera, as the site file says. The site has one. Error: its lens cannot be.
Result<vision::CameraModel> cameraOf(const show::Site& site);
// How the site's camera stores light. The site has one.
vision::CameraLight cameraLightOf(const show::Site& site);

// The share of the light that an output gives to each pixel, where outputs of a canvas overlap;
// null if it gives all of it.
std::shared_ptr<const render::BlendMap> blendOf(const show::Site& site, std::size_t output);

// Error: the site lacks a projector's place, the camera, or usable optics; it names what to add to
// the site file.
Result<site::NominalSite> simulationOf(const show::Site& site);

// Width / height of a canvas in the projectors' pixels: the mean over its outputs.
double canvasAspectInPixels(const show::Site& site, const std::string& canvas);
// Width / height of a canvas on the wall, or 0 if unknown. In this order: its `canvas_size`; in
// metres, if the site gives all its projectors and their surfaces; in pixels, if every output's
// corners form a rectangle. Keystoned corners alone do not tell the shape on the wall.
double canvasAspectOf(const show::Site& site, const std::string& canvas);

// What the comparison may know of one output, for a picture of this aspect (width / height) that
// lies on the canvas as `fit` says. Nothing if the site does not say where projector, surface and
// camera are: then the output is not scored.
Result<std::optional<vision::NominalView>> nominalViewOf(const show::Site& site, std::size_t output, double pictureAspect,
                                                         Fit fit);

// The outputs that the camera can watch, by output: those that were surveyed, or of which the site
// says where projector, surface and camera are. Empty if there are none, or if the site wants no
// correction of geometry, not even advice.
Result<std::vector<std::optional<vision::WatchedOutput>>> watchedOutputsOf(const show::Site& site);

}  // namespace fantascope::app
