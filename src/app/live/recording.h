#pragma once

#include "app/base/video_writer.h"
#include "app/live/table_file.h"

#include "show/site/site.h"

#include "device/display_sink.h"

#include "core/clock.h"
#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace fantascope::app {

// The recording of a run, in a folder:
//   NAME.mp4           the video of each output: every frame from the moment when it became visible until the next one did
//   frames.csv         refresh, show time, output and the hash of each recorded frame's pixels
//   dmx.csv            show time, universe and slots of each frame sent to the fixtures
//   relays.csv         show time, bank and states of each write to relays
//   camera-N.png       the site as the camera saw it at the end of cue N
//   contact-sheet.png  the same of all cues, with their names
// The videos end with the show. dmx.csv and relays.csv also hold the fade to the end levels and the
// safe states. If the target is a file that ends in .mp4, the recording is one video with the
// outputs side by side.
// If a video or a table cannot be written any further, as on a full disk, it ends there, and all
// else goes on. Videos have no name before finish(). Tables grow on the disk and are called
// NAME.csv.unfinished until then, so that they survive a sudden end of the program.
// Thread: frame() from one thread for each video, lighting() from one, cue() from one, relays()
// from any, writeTables() from one; begin() before and finish() after all of these.
class Recording {
public:
    struct Output {
        std::string name;
        glm::ivec2 size;
        double frameRate;
    };
    // Error: the target cannot be written, or is a file with another ending.
    static Result<std::unique_ptr<Recording>> open(const std::filesystem::path& target, std::vector<Output> outputs);
    // Of a site's outputs; null for an empty target: nobody wants one.
    static Result<std::unique_ptr<Recording>> ofSite(const std::filesystem::path& target, const show::Site& site);

    // Sets the moment at which all videos begin.
    void begin(Time runStart) { runStart_ = runStart; }
    // The outputs that each video shows. All frames of a video come from one thread.
    std::vector<std::vector<std::size_t>> videos() const;

    // Records that `picture` was shown on `output`. The moments of a video increase. Error, only
    // once: why the video ends here.
    Result<void> frame(std::size_t output, const RgbaImage& picture, const Shown& shown, Time showTime);
    void lighting(Time showTime, int universe, std::span<const std::uint8_t> slots);
    void relays(Time showTime, const std::string& bank, const std::vector<bool>& states);
    // Writes the tables' lines since the last call. Only this call and finish() wait for the disk
    // with tables. Errors: why a table ends here, once for each table.
    std::vector<Error> writeTables();
    // Takes a camera picture of a cue, counted from 0. finish() writes the last picture of each
    // cue.
    void cue(int index, const std::string& label, const RgbaImage& picture);

    // Finishes all files. Error: what could not be written; the rest is complete.
    Result<void> finish();
    // The frames of an output in its finished video; 0 if there is no video. Call it after
    // finish().
    std::int64_t recorded(std::size_t output) const { return frames_[output].count; }

private:
    struct Frames {
        std::int64_t count = 0;
        bool tiled = false;  // side by side: the newest frame is not written yet
    };
    // A line of frames.csv. Lines are ordered by show time, then by output, then by the order in
    // which the output showed the frames.
    struct Line {
        Time showTime;
        std::size_t output;
        std::int64_t number, refresh;
        std::uint64_t hash;
        bool operator<(const Line& other) const {
            return std::tie(showTime, output, number) < std::tie(other.showTime, other.output, other.number);
        }
    };
    struct Video {
        std::unique_ptr<VideoWriter> writer;  // null once it has failed
        std::int64_t number = -1;             // of the newest picture
        std::optional<Time> tiled;            // when the unwritten pictures side by side became visible; none: all are written
    };
    Recording(std::filesystem::path target, std::vector<Output> outputs);
    bool sideBySide() const { return target_.extension() == ".mp4"; }
    Result<void> write(Video& video, const RgbaImage& picture, Time at);
    Result<void> writeTiled();
    void addLine(const Line& line);
    void putOldestLine();  // into frames.csv; call it with linesMutex_ held

    std::filesystem::path target_;
    std::vector<Output> outputs_;
    Time runStart_{};
    std::vector<Frames> frames_;  // of each output
    std::vector<Video> videos_;   // one for each output, or one for all
    RgbaImage tiled_;             // the outputs side by side
    // Lines of frames.csv wait here for earlier lines of an output that is behind. At most so many
    // wait, because an output may show nothing at all.
    static constexpr std::size_t kMostLines = 4096;
    std::mutex linesMutex_;  // of:
    std::set<Line> lines_;
    std::vector<Time> newestLine_;  // show time, by output
    TableFile framesTable_, dmx_, relays_;
    std::map<int, std::pair<std::string, RgbaImage>> cues_;
};

}  // namespace fantascope::app
