#pragma once

#include "vision/structured_light.h"

#include "media/image.h"

#include <glm/vec2.hpp>

#include <optional>
#include <span>
#include <vector>

namespace fantascope::vision {

// One of the outputs that show parts of a canvas, and what a camera saw of its light. `map` and
// `share` outlive it.
struct LitOutput {
    const ProjectorMap* map = nullptr;
    const GreyImage* share = nullptr;  // by projector pixel: how much of a white canvas it gives there, linear, 0..1
    double brightness = 1;             // the linear light of its white, as a share of what the camera saw
};

// How far light may be evened out.
struct LightBounds {
    double least = 0.3;    // the least that is left of a place's light, > 0 .. 1
    double clipped = 0.1;  // the share of the places that may stay darker than the others, 0 .. 0.5
};

// What makes the light of a white canvas even: a factor for each projector pixel.
struct LightCompensation {
    std::vector<GreyImage> gains;         // by output, of its picture's size: least .. 1, linear
    double kept = 1;                      // how much is left of the light of a white canvas, 0..1
    double tooDark = 0, tooBright = 0;    // the share of the places that stay darker, and brighter, than the others
    double spread = 0, spreadBefore = 0;  // mean difference from the mean light, as a share of it
};

// Evens out the light of a canvas on a surface that is not evenly white, and under projectors whose
// light falls off: radiometric compensation (Nayar et al. 2003, Grossberg et al. 2004) of a grey
// picture. A camera pixel sees a place of the surface. The light of a white canvas there is e =
// sum(light * share * brightness) over the outputs; the compensated light is min(e, max(level,
// least * e)).
//
// `level` is the highest that leaves the allowed share of the places too dark, or a higher one if
// the brightest places could not be dimmed to it. At a place all outputs have the same factor, so
// blends stay right. The factors are smooth: a registration error of half a projector pixel changes
// none by more than some percent. Light that the camera cannot see gets the factor of its
// neighbourhood. What the camera's lens loses towards its corners counts as the surface's.
//
// Nothing: the camera sees too little of the canvas. Thread: reentrant.
std::optional<LightCompensation> compensateLight(std::span<const LitOutput> outputs, const LightBounds& bounds);

// The light of a map by projector pixel, for a picture of `size`: smooth, with the light of the
// neighbourhood where the camera sees none. Nothing: the map knows too few places.
std::optional<GreyImage> lightByProjectorPixel(const ProjectorMap& map, glm::ivec2 size);

}  // namespace fantascope::vision
