#include "app/lens/recorded_views.h"

#include "core/file.h"
#include "media/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

Result<std::vector<fs::path>> picturesIn(const fs::path& folder) {
    std::error_code failed;
    std::vector<fs::path> pictures;
    for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
        const std::string ending = endingOf(entry->path());
        if (ending == ".png" || ending == ".jpg" || ending == ".jpeg") pictures.push_back(entry->path());
    }
    if (failed) return Error(fmt::format("{}: {}", folder.string(), failed.message()));
    if (pictures.empty())
        return Error(fmt::format("{}: there is no picture; put PNG or JPEG pictures of the lens board there", folder.string()));
    std::ranges::sort(pictures);
    return pictures;
}

}  // namespace

Result<RecordedViews> recordedViews(const fs::path& folder, std::optional<glm::ivec2> size,
                                    const std::function<bool(double done)>& goesOn) {
    const std::vector<fs::path> pictures = TRY(picturesIn(folder));
    RecordedViews recorded;
    std::string first = "the site file says";
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        if (!goesOn(static_cast<double>(i) / static_cast<double>(pictures.size()))) break;
        const RgbaImage picture = TRY(readRgba(pictures[i]));
        const glm::ivec2 its(picture.width(), picture.height());
        if (!size) {
            size = its;
            first = pictures[i].filename().string() + " has";
        }
        if (its != *size)
            return Error(fmt::format("{} has {} x {} pixels, {} {} x {}; a lens is that of one size: take all pictures in it",
                                     pictures[i].string(), its.x, its.y, first, size->x, size->y));
        if (auto view = vision::findBoard(picture)) {
            recorded.views.push_back(std::move(*view));
            recorded.names.push_back(pictures[i].filename().string());
        } else {
            recorded.missed.count(vision::troubleOf(picture));
        }
    }
    return recorded;
}

}  // namespace fantascope::app
