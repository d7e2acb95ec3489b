#pragma once

#include "app/lens/board_watch.h"

#include "vision/lens_board.h"

#include "core/result.h"

#include <glm/vec2.hpp>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// What the pictures of a folder show of the board.
struct RecordedViews {
    std::vector<vision::BoardView> views;
    std::vector<std::string> names;  // of the files with these views
    Missed missed;                   // in the other pictures
};

// Reads every PNG and JPEG of a folder, in the order of their names. `size`: that they must have;
// nothing: all have the first one's. `goesOn` is asked before each picture and told the finished
// share; false: the rest is left out.
// Error: no folder, or one without pictures; a picture that cannot be read; pictures of different
// sizes.
Result<RecordedViews> recordedViews(const std::filesystem::path& folder, std::optional<glm::ivec2> size,
                                    const std::function<bool(double done)>& goesOn);

}  // namespace fantascope::app
