#pragma once

#include "vision/camera_model.h"
#include "vision/structured_light.h"

#include "core/result.h"
#include "core/warp.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace fantascope::vision {

// A point of the surface that projector and camera both know.
struct SharedPoint {
    glm::dvec2 camera{0.0};     // camera pixels
    glm::dvec2 projector{0.0};  // projector pixels
    glm::ivec2 patch{0};        // its column and row among all patches
};

// The shared points of a map: the mean over square patches of camera pixels, some thousand for a
// picture that fills the camera's. Averaging removes the noise of single pixels. Patches across a
// step of the surface, or with few known pixels, are left out.
//
// Through a camera's blur, a pixel sees more of its brighter side. If the blur is a Gaussian h of
// variance s^2, the mean place that it sees is s^2 grad log(h * surface) away from its middle
// (Robbins 1956). s^2 is estimated from the map, and this shift is corrected.
std::vector<SharedPoint> sharedPoints(const ProjectorMap& map);

// Where the picture is to stand, in the camera's picture.
struct WantedPlace {
    CameraModel camera;                   // its place in the world does not matter
    std::array<glm::dvec2, 4> corners{};  // of the whole canvas, clockwise from its top left, in camera pixels
};

// A warp that puts the canvas where it is wanted.
struct WarpFit {
    WarpShape shape;
    // Distances between where the warp sends points and where they were measured, in projector
    // pixels, inside the output's part of the canvas. Each is a mean over a point and its
    // neighbours, because a single point is noisy.
    double rms = 0, max = 0;
    double keystoneRms = 0, keystoneMax = 0;  // of the best keystone alone
    std::size_t points = 0;                   // how many were used
    double leftOut = 0;                       // share of the points that were not: they lie on something else
    bool flat = true;                         // a keystone is enough
};

// Fits a warp to shared points: a keystone, and a mesh if the surface is not flat. The part of the
// canvas and its orientation stay as in `now`. Things in front of the surface, or beside it, do not
// count if most of the points lie on one plane.
// Error: too few points inside the output's part of the canvas, or no warp can do this.
Result<WarpFit> fitWarp(const std::vector<SharedPoint>& points, const WantedPlace& wanted, const WarpShape& now);

}  // namespace fantascope::vision
