#pragma once

#include "show/site/site.h"

#include "media/projection.h"

#include <array>
#include <string_view>

namespace fantascope::show {

// A number of a projector's light that can be set by hand: its steps, coarse, usual and fine, and
// its range.
struct LightValue {
    std::string_view name;
    std::array<double, 3> steps;
    double low, high;
    double (*read)(const ProjectorLight&);
    void (*write)(ProjectorLight&, double);
};
constexpr double kUsualGamma = 2.2;  // the first gamma after sRGB
constexpr LightValue kLightValues[] = {
    {"brightness",
     {0.1, 0.01, 0.001},
     0,
     1,
     [](const ProjectorLight& light) { return light.brightness; },
     [](ProjectorLight& light, double value) { light.brightness = value; }},
    {"gamma",
     {0.1, 0.01, 0.001},
     1,
     4,
     [](const ProjectorLight& light) { return light.gamma.value_or(kUsualGamma); },
     [](ProjectorLight& light, double value) { light.gamma = value; }},
    {"black level",
     {0.001, 0.0001, 0.00001},
     0,
     kBrightestBlack,
     [](const ProjectorLight& light) { return light.blackLevel; },
     [](ProjectorLight& light, double value) { light.blackLevel = value; }},
    {"red of white",
     {0.05, 0.005, 0.001},
     0,
     1,
     [](const ProjectorLight& light) { return light.white.r; },
     [](ProjectorLight& light, double value) { light.white.r = value; }},
    {"green of white",
     {0.05, 0.005, 0.001},
     0,
     1,
     [](const ProjectorLight& light) { return light.white.g; },
     [](ProjectorLight& light, double value) { light.white.g = value; }},
    {"blue of white",
     {0.05, 0.005, 0.001},
     0,
     1,
     [](const ProjectorLight& light) { return light.white.b; },
     [](ProjectorLight& light, double value) { light.white.b = value; }},
};

}  // namespace fantascope::show
