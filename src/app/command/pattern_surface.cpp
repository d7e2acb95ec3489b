#include "app/command/pattern_surface.h"

#include "app/site/light_correction.h"
#include "app/site/site_file.h"
#include "app/site/site_models.h"

#include "pattern/search/refit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::app {
namespace {

constexpr int kRows = 360;  // the survey sees no finer
// White is chosen so that this share of the guide's light cannot be had.
constexpr double kMissing = 0.01;

}  // namespace

Result<std::shared_ptr<const GreyImage>> readPatternSurface(const std::string& place, const GreyImage& guide) {
    const std::size_t colon = place.rfind(':');
    if (colon == std::string::npos || colon == 0)
        return Error(fmt::format("--surface {}: write SITE:OUTPUT, such as site.yaml:left", place));
    const show::Site site = TRY(readSite(place.substr(0, colon)));
    const std::size_t output = TRY(outputNamed(site, place.substr(colon + 1)));
    const double aspect = double(guide.width()) / guide.height();
    const glm::ivec2 size(std::max(1L, std::lround(kRows * aspect)), kRows);
    GreyImage surface = TRY(canvasSurface(site, output, aspect, Fit::Contain, size).in("--surface " + place)).light();
    const double white = pattern::reachableWhite(surface, resized(guide, size.x, size.y), kMissing);
    if (white <= 0) return Error(fmt::format("--surface {}: the camera saw no light where the guide is lit", place));
    for (float& light : surface.pixels()) light = static_cast<float>(light / white);
    return std::make_shared<const GreyImage>(std::move(surface));
}

}  // namespace fantascope::app
