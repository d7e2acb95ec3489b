#pragma once

#include "app/live/show_run.h"
#include "app/live/watch.h"

#include "render/source/picture_source.h"
#include "show/playback.h"
#include "show/show.h"
#include "show/site.h"

#include "core/result.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace fantascope::app {

// Everything that a run reads from files, before anything lights up. Constant afterwards, but for
// what moves in its pictures.
struct Programme {
    show::Show show;
    show::Site site;
    show::CueList cues;
    std::optional<show::Input> firstInput;        // the cue to start from
    std::vector<render::PictureSource> sources;   // in the order of Show::sources
    std::shared_ptr<render::PictureFeed> camera;  // what the camera's sources show; null where the site has none
    std::vector<Watch::Comparisons> comparisons;  // [output][source]
};

// A pattern with its movement, ready to be drawn. Error: as pattern::readPattern.
Result<render::PatternSource> readPatternSource(const std::filesystem::path& file);

// A show's source, ready to be drawn. `camera`: what a camera's source shows; null if the site has
// none. Error: the source's place, and that of whatever is wrong in its files.
Result<render::PictureSource> readPictureSource(const show::Source& source, render::VideoStream::Pace pace,
                                                const std::shared_ptr<render::PictureFeed>& camera);

// Error: all sources that cannot be used, with their places and what to do.
Result<Programme> readProgramme(const RunOptions& options);

}  // namespace fantascope::app
