#pragma once

#include "app/live/show_run.h"
#include "app/live/watch.h"

#include "render/source/picture_source.h"
#include "show/playback.h"
#include "show/revision.h"

#include "core/result.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace fantascope::app {

// Everything that a run reads from files, before anything lights up. Constant afterwards, but for
// what moves in its pictures.
struct Programme {
    explicit Programme(std::shared_ptr<const show::Revision> played)
        : revision(std::move(played)), show(revision->show), site(revision->site), cues(show::Revision::cuesOf(revision)) {}

    std::shared_ptr<const show::Revision> revision;
    const show::Show& show;  // of `revision`, as these:
    const show::Site& site;
    std::shared_ptr<const show::CueList> cues;
    std::optional<show::Input> firstInput;        // the cue to start from
    render::PictureSources sources;               // in the order of Show::sources
    std::shared_ptr<render::PictureFeed> camera;  // what the camera's sources show; null where the site has none
    std::vector<Watch::Comparisons> comparisons;  // [output]
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
