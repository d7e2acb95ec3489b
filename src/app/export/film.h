#pragma once

#include "app/base/command_line.h"
#include "app/export/off_screen.h"

#include "core/clock.h"
#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace fantascope::app {

// Which frames of a show, or of a single pattern, are wanted.
struct FilmRequest {
    std::filesystem::path what;       // a show's folder, or a *.pattern.yaml
    std::string output;               // name of the site's output; required for shows
    std::filesystem::path site;       // for shows; empty: config/simulated
    std::string cue;                  // show only this cue, faded in, with the movement from its beginning
    std::string from;                 // or enter this cue at once and play on; if both are empty, play from the beginning
    std::optional<double> seconds;    // default: a minute; for a pattern or a single cue one loop of the movement
    std::optional<double> frameRate;  // Hz; default: the output's; for a pattern 30
    std::optional<glm::ivec2> size;   // pixels; default: the output's; for a pattern or a canvas 1080 rows in its aspect
    bool canvas = false;              // the whole canvas, without the output's warp; a pattern has none anyway
};

// Declares --output, --site, --cue and --from, for every command that takes a show.
void declareFilmOptions(Command& command, FilmRequest& request);

// An output's frames by show time, as the projector would get them. The show plays without its
// devices, and GO is pressed as in a rehearsal.
// Thread: thread-bound.
class Film {
public:
    // Error: as readProgramme(); no such output or cue; options for shows with a pattern; far too
    // many frames.
    static Result<Film> open(const FilmRequest& request);

    glm::ivec2 size() const { return size_; }
    double frameRate() const { return frameRate_; }
    std::int64_t frames() const { return frames_; }  // at least 1
    // The frame at show time `time`, stored values; `time` must rise from call to call. Valid until
    // the next call.
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
