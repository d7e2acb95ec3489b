#pragma once

#include "app/video_writer.h"

#include "core/clock.h"
#include "core/image.h"
#include "core/result.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace fantascope::app {

// What a run leaves to look at, in a folder:
//   NAME.mp4           the video of each output
//   frames.csv         refresh, show time, output and the hash of each recorded frame's pixels
//   dmx.csv            show time, universe and slots of each frame sent to the lamps
//   relays.csv         show time, bank and states whenever relays were written
//   contact-sheet.png  the site as the camera saw it at the end of each cue
// or, where the target is a file that ends in .mp4, one video with the outputs side by side.
// Thread: frame() from one thread, lighting() from one, cue() from one, relays() from any; finish() when these have ended.
class Recording {
public:
    struct Output {
        std::string name;
        glm::ivec2 size;
        double frameRate;
    };
    // Error: the target cannot be written, or is a file with another ending.
    static Result<std::unique_ptr<Recording>> open(const std::filesystem::path& target, std::vector<Output> outputs);

    // `picture` was shown on `output` from `refresh` on. Refreshes of one output rise; one that was seen already is left out.
    Result<void> frame(std::size_t output, const RgbaImage& picture, std::int64_t refresh, Time showTime);
    void lighting(Time showTime, int universe, std::span<const std::uint8_t> slots);
    void relays(Time showTime, const std::string& bank, const std::vector<bool>& states);
    // The newest camera picture of a cue; the last one given for a cue goes onto the contact sheet.
    void cue(int index, const std::string& label, const RgbaImage& picture);

    Result<void> finish();

private:
    struct Video {
        std::unique_ptr<VideoWriter> writer;
        std::int64_t firstRefresh = -1, lastRefresh = -1;
    };
    Recording(std::filesystem::path target, std::vector<Output> outputs)
        : target_(std::move(target)), outputs_(std::move(outputs)) {}
    bool sideBySide() const { return target_.extension() == ".mp4"; }

    std::filesystem::path target_;
    std::vector<Output> outputs_;
    std::vector<Video> videos_;  // one for each output, or one for all
    RgbaImage tiled_;            // the outputs side by side
    std::string frames_ = "refresh,show_time_s,output,fnv1a64\n";
    std::string dmx_ = "show_time_s,universe,slots\n";
    std::mutex relaysMutex_;
    std::string relays_ = "show_time_s,bank,states\n";
    std::map<int, std::pair<std::string, RgbaImage>> cues_;
};

}  // namespace fantascope::app
