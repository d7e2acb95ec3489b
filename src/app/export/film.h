#pragma once

#include "app/export/off_screen.h"

#include "core/clock.h"
#include "core/result.h"
#include "media/image.h"

#include <CLI/CLI.hpp>
#include <glm/vec2.hpp>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace fantascope::app {

// Which pictures are wanted of a show, or of a single pattern, and when.
struct FilmRequest {
    std::filesystem::path what;       // a show's folder, or a *.pattern.yaml
    std::string output;               // of the site; for shows, which need it
    std::filesystem::path site;       // for shows; empty: the simulated one
    std::string cue;                  // this one alone, faded in, the movement from its beginning
    std::string from;                 // or: enter this one at once and play on; neither: from the beginning
    std::optional<double> seconds;    // default: a minute; of a pattern or a single cue one loop of the movement
    std::optional<double> frameRate;  // default: the output's; of a pattern 30 Hz
    std::optional<glm::ivec2> size;   // default: the output's; of a pattern or a canvas 1080 rows in its shape
    bool canvas = false;              // without the output's keystone; a pattern has none
};

// The options --output, --site, --cue and --from, the same wherever a show may be named.
void declareFilmOptions(CLI::App& command, FilmRequest& request);

// An output's frames by show time, as the projector would get them: the show plays without its
// devices, GO is pressed as in a rehearsal.
// Thread: thread-bound.
class Film {
public:
    // Error: as readProgramme; an output or cue that is not there; options that are for shows
    // alone; more frames than anybody wants.
    static Result<Film> open(const FilmRequest& request);

    glm::ivec2 size() const { return size_; }
    double frameRate() const { return frameRate_; }
    std::int64_t frames() const { return frames_; }  // at least 1
    // Stored values at show time `time`; times rise from call to call. Valid until the next call.
    const RgbaImage& at(Time time) {
        const Seen seen = seenAt_(time);
        return screen_->draw(seen.picture, seen.wind, time);
    }

private:
    struct Seen {
        const show::OutputState& picture;
        Wind wind;
    };
    static Result<Film> ofPattern(const FilmRequest& request);
    static Result<Film> ofShow(const FilmRequest& request);

    glm::ivec2 size_{0};
    double frameRate_ = 0, seconds_ = 0;
    std::int64_t frames_ = 0;
    std::unique_ptr<OffScreen> screen_;
    std::function<Seen(Time)> seenAt_;
};

}  // namespace fantascope::app
