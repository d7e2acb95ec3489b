#include "app/command/wall_sight.h"

#include "app/live/programme.h"
#include "app/site/light_correction.h"
#include "app/site/site_file.h"
#include "app/site/site_models.h"

#include "pattern/shape/shape_pattern.h"
#include "vision/compare/guide_comparison.h"

#include "plot/wall_figure.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

// A guide, and in which space its drawing is.
struct WallGuide {
    Guide guide;
    pattern::CompareSpace compare;

    // As a picture file stores it.
    GreyImage stored(GreyImage values) const {
        if (compare == pattern::CompareSpace::Light)
            for (float& value : values.pixels()) value = srgbFromLinear(value);
        return values;
    }
};

// A drawing without a pattern is compared in light, as `fantascope pattern` does by default.
Result<WallGuide> readWallGuide(const fs::path& file) {
    if (file.extension() == ".yaml") {
        const pattern::ShapePattern pattern = TRY(pattern::readPattern(file));
        return WallGuide{TRY(readGuide(pattern, file)), pattern.compare};
    }
    const GreyImage light = comparedGuide(TRY(readGrey(file)), pattern::GuideTransfer::Srgb, pattern::CompareSpace::Light);
    return WallGuide{{light, light, static_cast<double>(light.width()) / light.height()}, pattern::CompareSpace::Light};
}

Result<plot::WallSight> sightOf(const fs::path& file, const vision::GuideComparison& comparison, const WallGuide& guide,
                                const show::Site& site, const std::string& output) {
    const RgbaImage picture = TRY(readRgba(file));
    const glm::ivec2 size = site.nominalCamera->size;
    if (picture.width() != size.x || picture.height() != size.y)
        return Error(
            fmt::format("{}: has {} x {} pixels, but the camera of {} has {} x {}; take a camera-N.png that "
                        "--record wrote on this site",
                        file.string(), picture.width(), picture.height(), site.file.string(), size.x, size.y));
    const auto likeness = comparison.compare(picture);
    auto seen = comparison.pictures(picture);
    if (!likeness || !seen)
        return Error(
            fmt::format("{}: shows nothing of '{}' that could be compared: it is dark there, has no contrast, or the "
                        "camera sees less than half of the picture; take a picture of a cue that shows the guide",
                        file.string(), output));
    return plot::WallSight{file.filename().string(),
                           guide.stored(std::move(seen->wanted)),
                           guide.stored(std::move(seen->seen)),
                           std::move(seen->difference),
                           std::move(seen->inSight),
                           likeness->z,
                           likeness->tone};
}

}  // namespace

Result<plot::Page> drawWall(const fs::path& picture, const WallRequest& request) {
    if (request.site.empty() || request.output.empty() || request.guide.empty())
        return Error(
            fmt::format("{}: to compare a camera's picture, say where it was taken and what was wanted: --site SITE "
                        "--output NAME --guide PATTERN or a drawing",
                        picture.string()));
    const show::Site site = TRY(readSite(request.site));
    const std::size_t output = TRY(outputNamed(site, request.output));
    const WallGuide guide = TRY(readWallGuide(request.guide));
    const auto gains = gainsToApply(site, lightCorrectionsOf(site));
    const auto comparison = TRY(comparisonWith(guide.guide, site, output, gains[output] != nullptr));
    if (!comparison)
        return Error(
            fmt::format("{}: does not say where the camera, the projector of '{}' and its surface are; add their places "
                        "(docs/site-format.md)",
                        site.file.string(), request.output));
    std::vector<plot::WallSight> sights;
    for (const fs::path& file : {request.before, picture})
        if (!file.empty()) sights.push_back(TRY(sightOf(file, *comparison, guide, site, request.output)));
    return plot::wallFigure(request.output, guide.stored(guide.guide.drawing), sights);
}

}  // namespace fantascope::app
