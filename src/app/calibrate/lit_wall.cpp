#include "app/calibrate/lit_wall.h"

#include <algorithm>
#include <cstddef>

namespace fantascope::app {

GreyImage litWall(const std::vector<const LightSurvey::Output*>& surveys) {
    GreyImage light = surveys.at(0)->dark;
    for (const LightSurvey::Output* const survey : surveys)
        for (std::size_t i = 0; i < light.pixels().size(); ++i)
            light.pixels()[i] += survey->full.pixels()[i] - survey->dark.pixels()[i];
    return light;
}

GreyImage litWallPicture(const std::vector<const LightSurvey::Output*>& surveys) {
    constexpr double kBrightPart = 0.995;  // of the pixels; the others may be white
    GreyImage picture = litWall(surveys);
    std::vector<float> values(picture.pixels().begin(), picture.pixels().end());
    const auto bright = values.begin() + static_cast<std::ptrdiff_t>(kBrightPart * static_cast<double>(values.size() - 1));
    std::ranges::nth_element(values, bright);
    const float white = std::max(*bright, 1e-6f);
    for (float& value : picture.pixels()) value = srgbFromLinear(std::clamp(value / white, 0.0f, 1.0f));
    return picture;
}

}  // namespace fantascope::app
