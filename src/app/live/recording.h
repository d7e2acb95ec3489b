#pragma once

#include "app/base/video_writer.h"
#include "app/live/table_file.h"

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

// What a run leaves to look at, in a folder:
//   NAME.mp4           the video of each output: every frame at the moment when it became visible, until the next one did
//   frames.csv         refresh, show time, output and the hash of each recorded frame's pixels
//   dmx.csv            show time, universe and slots of each frame sent to the lamps
//   relays.csv         show time, bank and states whenever relays were written
//   contact-sheet.png  the site as the camera saw it at the end of each cue
// The pictures end with the show; dmx.csv and relays.csv hold the lamps' fade to the end levels and
// the relays' safe states, too. Or, where the target is a file that ends in .mp4, one video with
// the outputs side by side.
// A video or a table that cannot be written any further, as on a full disk, ends there; all else
// goes on. Videos have no name before finish(). Tables grow on the disk and are called
// NAME.csv.unfinished until then, so that a sudden end of the program leaves them.
// Thread: frame() from one thread for each video, lighting() from one, cue() from one, relays()
// from any, writeTables() from one; begin() before and finish() after these.
class Recording {
public:
    struct Output {
        std::string name;
        glm::ivec2 size;
        double frameRate;
    };
    // Error: the target cannot be written, or is a file with another ending.
    static Result<std::unique_ptr<Recording>> open(const std::filesystem::path& target, std::vector<Output> outputs);

    // All videos begin with the run.
    void begin(Time runStart) { runStart_ = runStart; }
    // Which outputs a video shows; of each video in turn. Every frame of these is given on one
    // thread.
    std::vector<std::vector<std::size_t>> videos() const;

    // `picture` was shown on `output`. The moments of one video rise. Error: why its video ends
    // here, once.
    Result<void> frame(std::size_t output, const RgbaImage& picture, const Shown& shown, Time showTime);
    void lighting(Time showTime, int universe, std::span<const std::uint8_t> slots);
    void relays(Time showTime, const std::string& bank, const std::vector<bool>& states);
    // Writes the lines that the tables were given since the last call; no other call waits for the
    // disk with them. Errors: why a table ends here, each once.
    std::vector<Error> writeTables();
    // The newest camera picture of a cue; the last one given for a cue goes onto the contact sheet.
    void cue(int index, const std::string& label, const RgbaImage& picture);

    // Error: all that cannot be written; the rest is.
    Result<void> finish();
    // Frames of an output in the video that is left; 0 where none is. After finish().
    std::int64_t recorded(std::size_t output) const { return frames_[output].count; }

private:
    struct Frames {
        std::int64_t count = 0;
        bool tiled = false;  // side by side: the newest is not written yet
    };
    // Of frames.csv. Where show times meet, the order of the outputs decides, then that in which an
    // output showed them.
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
        std::optional<Time> tiled;            // when the outputs side by side became visible; none while they are written
    };
    Recording(std::filesystem::path target, std::vector<Output> outputs);
    bool sideBySide() const { return target_.extension() == ".mp4"; }
    Result<void> write(Video& video, const RgbaImage& picture, Time at);
    Result<void> writeTiled();
    void addLine(const Line& line);
    void putOldestLine();  // into frames.csv; with linesMutex_

    std::filesystem::path target_;
    std::vector<Output> outputs_;
    Time runStart_{};
    std::vector<Frames> frames_;  // of each output
    std::vector<Video> videos_;   // one for each output, or one for all
    RgbaImage tiled_;             // the outputs side by side
    // Lines of frames.csv that an output which is behind may still have to come before. One that
    // shows nothing is not waited for beyond so many.
    static constexpr std::size_t kMostLines = 4096;
    std::mutex linesMutex_;  // of:
    std::set<Line> lines_;
    std::vector<Time> newestLine_;  // show time, of each output
    TableFile framesTable_, dmx_, relays_;
    std::map<int, std::pair<std::string, RgbaImage>> cues_;
};

}  // namespace fantascope::app
