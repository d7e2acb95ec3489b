#include "app/live/screenshots.h"

#include "media/image.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

namespace fantascope::app {
namespace {

// Pictures are taken this long after the request. Frames that are in progress at the request are
// for earlier moments, so every output gives its picture of the same moment.
constexpr Time kAhead = std::chrono::milliseconds(100);
constexpr Time kPatience = std::chrono::seconds(3);  // timeout for an output's frame

// A cue's name as part of a file name. Letters of any alphabet, digits and '_' stay. All other
// characters become '-', because a shell or another system might interpret them.
std::string inFileName(std::string text) {
    for (char& letter : text) {
        const auto byte = static_cast<unsigned char>(letter);
        const bool plain = (byte >= 'a' && byte <= 'z') || (byte >= 'A' && byte <= 'Z') || (byte >= '0' && byte <= '9') ||
                           byte == '_' || byte >= 0x80;
        if (!plain) letter = '-';
    }
    return text;
}

}  // namespace

Screenshots::Screenshots(std::filesystem::path folder, const show::PlayedShow& show, const show::InputLog& inputs,
                         const std::vector<std::string>& outputs, const std::vector<render::NewestFrame*>& frames,
                         const show::ShowClock& showClock, show::EventLog& events)
    : folder_(std::move(folder)), show_(show), showClock_(showClock), events_(events), replica_(inputs) {
    for (std::size_t i = 0; i < outputs.size(); ++i) outputs_.push_back({outputs[i], frames[i]});
}

void Screenshots::tick(Time moment) {
    const Time showTime = showClock_.showTime(moment);
    replica_.stateAt(showTime, state_);  // takes the inputs, even if there is no picture to name
    if (std::ranges::none_of(outputs_, &Output::awaited) && wanted_.exchange(false)) {
        from_ = showClock_.showTime(moment + kAhead);
        until_ = moment + kAhead + kPatience;
        for (Output& output : outputs_) {
            output.frames->ask(from_);
            output.awaited = true;
        }
    }
    for (Output& output : outputs_) {
        if (!output.awaited) continue;
        const render::ShownFrame* const frame = output.frames->next(moment);
        // A frame of an earlier request that timed out may still come; it is ignored.
        if (frame != nullptr && frame->showTime >= from_) {
            const Result<std::filesystem::path> file = write(output.name, *frame);
            if (file)
                events_.append({showTime, show::event::PictureTaken{*file}});
            else
                events_.append({showTime, show::event::PictureMissed{file.error().message()}});
            output.awaited = false;
        } else if (moment > until_) {
            events_.append({showTime, show::event::PictureMissed{fmt::format("'{}' shows nothing", output.name)}});
            output.awaited = false;
        }
    }
}

Result<std::filesystem::path> Screenshots::write(const std::string& output, const render::ShownFrame& frame) {
    replica_.stateAt(frame.showTime, state_);
    const std::vector<show::Cue>& cues = show_.at(state_.revision).show.cues;
    const std::string cue =
        state_.cue < 0 ? "before-the-first-cue"
                       : fmt::format("{}-{}", state_.cue + 1, inFileName(cues[static_cast<std::size_t>(state_.cue)].name));
    const std::string name = fmt::format("{:09.3f}s-{}-{}", seconds(frame.showTime), cue, output);
    // Existing pictures, such as those of another night, are not overwritten.
    std::error_code unknown;  // ignored: an error will show when the file is written
    std::filesystem::path file = folder_ / (name + ".png");
    for (int copy = 2; std::filesystem::exists(file, unknown); ++copy) file = folder_ / fmt::format("{}-{}.png", name, copy);
    TRY(writePng(file, frame.image));
    return file;
}

}  // namespace fantascope::app
