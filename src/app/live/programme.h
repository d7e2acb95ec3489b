#pragma once

#include "app/keys/go_schedule.h"
#include "app/live/show_run.h"
#include "app/live/watch.h"
#include "app/reload/show_reload.h"
#include "app/site/light_correction.h"
#include "app/watch/pattern_correction.h"

#include "pattern/shape/shape_pattern.h"
#include "render/source/picture_source.h"
#include "show/play/playback.h"
#include "show/revision.h"
#include "vision/compare/guide_comparison.h"

#include "core/fit.h"
#include "core/result.h"
#include "media/image.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace fantascope::app {

// Reads the files of a show's source, so that it is ready to be drawn. `camera`: the pictures of a
// camera source; null if the site has no camera. Error: the place of the source, and the place of
// the fault in its files.
Result<render::PictureSource> readPictureSource(const show::Source& source, render::VideoStream::Pace pace,
                                                const std::shared_ptr<render::PictureFeed>& camera);

// Everything that a run reads from files before it shows anything. It is constant afterwards,
// except for the decoding of videos and for camera pictures.
struct Programme {
    explicit Programme(std::shared_ptr<const show::Revision> played)
        : revision(std::move(played)), show(revision->show), site(revision->site), cues(show::Revision::cuesOf(revision)) {}

    std::shared_ptr<const show::Revision> revision;
    const show::Show& show;                     // of `revision`
    const show::Site& site;                     // of `revision`
    std::shared_ptr<const show::CueList> cues;  // of `revision`
    const show::Nights* nights() const { return revision->nights ? &*revision->nights : nullptr; }
    std::optional<Time> wallFrom;           // UTC that the run's wall clock shows at first; nothing: it is the machine's
    std::optional<show::Input> firstInput;  // the cue to start with: that of --from, or the show's own
    std::optional<std::size_t> firstCue() const {
        return firstInput ? std::optional(static_cast<std::size_t>(firstInput->cue)) : std::nullopt;
    }
    show::SourceNames names;  // by which the show was read
    // The files of a run that lasts no longer than this. `adopt` takes the projections of a saved
    // site.
    ShowReload::Files files(std::function<void(std::vector<Projection>)> adopt) const;
    render::PictureSources sources;               // in the order of Show::sources
    std::shared_ptr<render::PictureFeed> camera;  // the pictures of camera sources; null if the site has no camera
    std::vector<Watch::Comparisons> comparisons;  // [output]
    std::vector<std::optional<vision::WatchedOutput>>
        watched;                          // [output]; nothing: it cannot be watched, or the site does not want it
    std::vector<LightCorrection> light;   // of the canvases; applied if the site file says so
    std::vector<PatternOnWall> patterns;  // that may be fitted to the wall
};

// What the light of a source's picture is to be.
struct Guide {
    GreyImage drawing;  // as in the search for the pattern (comparedGuide)
    GreyImage light;    // the same in linear light
    double aspect = 1;  // width / height of the source's picture
    Fit fit = Fit::Contain;
};
// `file`: of the pattern. Error: its drawing cannot be read.
Result<Guide> readGuide(const pattern::ShapePattern& pattern, const std::filesystem::path& file);

// How the camera's pictures of an output compare with a guide. `isEvenedOut`: the site's light
// correction is applied to the output. Nothing if the site does not say where projector, surface
// and camera are.
Result<std::optional<vision::GuideComparison>> comparisonWith(const Guide& guide, const show::Site& site, std::size_t output,
                                                              bool isEvenedOut);

// Reads a pattern with its movement, ready to be drawn. Error: as pattern::readPattern.
Result<render::PatternSource> readPatternSource(const std::filesystem::path& file);

// Adds the videos' late and damaged frames.
void addVideos(const Programme& programme, RunReport& report);

// The schedule of a rehearsal of this length, from the cue `first` or the dark on: every cue is
// entered. There is none for a show that plays by itself or by its own schedule.
GoSchedule goScheduleOf(const Programme& programme, std::optional<std::size_t> first, Time length);

// Reads everything that a run with these options needs. Error: what is wrong, with its place and
// advice; all faulty sources at once.
Result<Programme> readProgramme(const RunOptions& options);

}  // namespace fantascope::app
