#include "app/base/silhouette_file.h"

#include "app/base/drawing.h"

#include "theatre/energy/pose_problem.h"

#include "core/log.h"

#include <fmt/format.h>

#include <algorithm>

namespace fantascope::app {
namespace {

// A pixel is coloured if its channels differ by more than this. A picture is coloured if more than
// this share of its pixels is: JPEG colours edges a little.
constexpr int kGreyish = 64;
constexpr double kColouredShare = 0.01;

bool isColoured(const RgbaImage& picture) {
    const auto coloured = std::count_if(picture.pixels().begin(), picture.pixels().end(), [](Rgba8 pixel) {
        const auto [least, most] = std::minmax({pixel.r, pixel.g, pixel.b});
        return (most - least) * pixel.a > kGreyish * 255;
    });
    return static_cast<double>(coloured) > kColouredShare * static_cast<double>(picture.pixels().size());
}

}  // namespace

Result<GreyImage> readSilhouette(const std::filesystem::path& file) {
    const glm::ivec2 size = TRY(pictureSize(file));
    TRY(theatre::PoseTarget::checkSize(size.x, size.y).in(file.string()));
    if (isColoured(TRY(readRgba(file))))
        return Error(fmt::format("{}: is a picture in colours; draw it white on black: white is where the shadow is to be",
                                 file.string()));
    return readGrey(file);
}

Result<GreyImage> readDrawnSilhouette(const std::filesystem::path& file, bool invert) {
    GreyImage silhouette = TRY(readSilhouette(file));
    TRY(checkDrawn(silhouette, file));
    if (isInkOnPaper(silhouette) && !invert)
        log::warning("silhouette",
                     fmt::format("{}: looks like black ink on white paper, and white is where the shadow is to be; with "
                                 "--invert the ink is",
                                 file.string()));
    if (invert) silhouette = inverted(std::move(silhouette));
    if (const std::string odd = oddHolesIn(silhouette); !odd.empty())
        log::warning("silhouette", fmt::format("{}: {}", file.string(), odd));
    return silhouette;
}

}  // namespace fantascope::app
