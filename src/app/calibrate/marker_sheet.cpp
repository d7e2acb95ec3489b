#include "app/calibrate/marker_sheet.h"

#include "vision/corner_markers.h"

#include "core/file.h"
#include "plot/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace fantascope::app {
namespace {

using vision::CornerMarker;

constexpr int kSheetWidth = 595, kSheetHeight = 842;  // points
constexpr int kCell = 71;                             // points, 25 mm; whole ones, so that no seam shows between two cells

plot::Page sheetOf(std::size_t marker) {
    plot::Page page(kSheetWidth, kSheetHeight);
    const glm::dvec2 low = (glm::ivec2(kSheetWidth, kSheetHeight) - CornerMarker::kCells * kCell) / 2;
    page.box(low, low + double(CornerMarker::kCells * kCell), glm::dvec3(0));
    const std::vector<bool> dark = CornerMarker::darkCells(marker);
    for (int y = 0; y < CornerMarker::kCells; ++y)
        for (int x = 0; x < CornerMarker::kCells; ++x)
            if (!dark[static_cast<std::size_t>(y) * CornerMarker::kCells + static_cast<std::size_t>(x)])
                page.box(low + double(kCell) * glm::dvec2(x, y), low + double(kCell) * glm::dvec2(x + 1, y + 1), glm::dvec3(1));
    const glm::dvec2 below(kSheetWidth / 2.0, kSheetHeight - 0.5 * low.y);
    page.text(fmt::format("Fantascope corner marker: {}", CornerMarker::kNames[marker]), below - glm::dvec2(0, 12), 18,
              plot::Anchor::Middle);
    page.text("Its middle is where the canvas's corner is to be. Keep the white rim.", below + glm::dvec2(0, 12), 12,
              plot::Anchor::Middle);
    return page;
}

}  // namespace

Result<std::vector<std::filesystem::path>> writeMarkerSheets(const std::filesystem::path& file) {
    const std::string ending = endingOf(file);
    if (ending != ".pdf" && ending != ".svg" && ending != ".png")
        return Error(fmt::format("{}: the markers' name must end in .pdf, .svg or .png", file.string()));
    std::vector<std::filesystem::path> files;
    for (std::size_t marker = 0; marker < CornerMarker::kNames.size(); ++marker) {
        std::string corner(CornerMarker::kNames[marker]);
        std::ranges::replace(corner, ' ', '-');
        files.push_back(file.parent_path() / fmt::format("{}-{}{}", file.stem().string(), corner, ending));
        const plot::Page page = sheetOf(marker);
        TRY(ending == ".png" ? page.write(files.back()) : page.writeAsPaper(files.back()));
    }
    return files;
}

}  // namespace fantascope::app
