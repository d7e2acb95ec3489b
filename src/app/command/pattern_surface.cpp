#include "app/command/pattern_surface.h"

#include "app/site/light_correction.h"
#include "app/site/site_file.h"
#include "app/site/site_models.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::app {
namespace {

constexpr int kRows = 360;  // the survey sees no finer
// White is chosen so that this share of the guide's light cannot be had.
constexpr double kMissing = 0.01;

// The light that stands for the guide's white: the highest for which the surface lacks no more than
// the share kMissing of the guide's light.
double whiteOf(const GreyImage& surface, const GreyImage& guide) {
    double wanted = 0, high = 0;
    for (std::size_t i = 0; i < guide.pixels().size(); ++i) {
        wanted += guide.pixels()[i];
        high = std::max(high, double(surface.pixels()[i]));
    }
    const auto missing = [&](double white) {
        double sum = 0;
        for (std::size_t i = 0; i < guide.pixels().size(); ++i)
            sum += std::max(0.0, guide.pixels()[i] - surface.pixels()[i] / white);
        return sum;
    };
    double low = 0;
    constexpr int kHalvings = 24;
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = (low + high) / 2;
        (missing(middle) <= kMissing * wanted ? low : high) = middle;
    }
    return wanted > 0 ? low : 0;
}

}  // namespace

Result<std::shared_ptr<const GreyImage>> readPatternSurface(const std::string& place, const GreyImage& guide) {
    const std::size_t colon = place.rfind(':');
    if (colon == std::string::npos || colon == 0)
        return Error(fmt::format("--surface {}: write SITE:OUTPUT, such as site.yaml:left", place));
    const show::Site site = TRY(readSite(place.substr(0, colon)));
    const std::size_t output = TRY(outputNamed(site, place.substr(colon + 1)));
    const double aspect = double(guide.width()) / guide.height();
    const glm::ivec2 size(std::max(1L, std::lround(kRows * aspect)), kRows);
    GreyImage surface = TRY(surfaceLight(site, output, aspect, Fit::Contain, size).in("--surface " + place));
    const double white = whiteOf(surface, resized(guide, size.x, size.y));
    if (white <= 0) return Error(fmt::format("--surface {}: the camera saw no light where the guide is lit", place));
    for (float& light : surface.pixels()) light = static_cast<float>(light / white);
    return std::make_shared<const GreyImage>(std::move(surface));
}

}  // namespace fantascope::app
