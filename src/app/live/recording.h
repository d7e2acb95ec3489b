#pragma once

#include "app/base/video_writer.h"

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
#include <span>
#include <string>
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
// A video that cannot be written any further, as on a full disk, is left out; all else goes on.
// Thread: frame() from one thread for each video, lighting() from one, cue() from one, relays()
// from any; begin() before and finish() after these.
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
        struct Line {
            std::int64_t refresh;
            Time showTime;
            std::uint64_t hash;
        };
        std::vector<Line> lines;
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
    std::string framesTable() const;

    std::filesystem::path target_;
    std::vector<Output> outputs_;
    Time runStart_{};
    std::vector<Frames> frames_;  // of each output
    std::vector<Video> videos_;   // one for each output, or one for all
    RgbaImage tiled_;             // the outputs side by side
    std::string dmx_ = "show_time_s,universe,slots\n";
    std::mutex relaysMutex_;
    std::string relays_ = "show_time_s,bank,states\n";
    std::map<int, std::pair<std::string, RgbaImage>> cues_;
};

}  // namespace fantascope::app
