#pragma once

#include "render/output_renderer.h"
#include "render/source/picture_source.h"
#include "show/play/playback.h"
#include "show/source_id.h"

#include "core/clock.h"
#include "core/latest_value.h"
#include "core/result.h"

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::app {

// The sources that a run can draw. They change when the show is revised: whoever has read the new
// files asks for the new sources, the render thread gives them to its renderers, and takes the old
// ones away once nothing needs them. A pattern may be exchanged, too. So that no frame is late, one
// renderer gets one thing a frame.
// Thread: ask(), outcome() and release() from one thread, makeReady() from one; all else on the
// render thread.
class SourceStock {
public:
    using Sources = std::shared_ptr<const render::PictureSources>;

    explicit SourceStock(render::PictureSources first)
        : all_(std::make_shared<const render::PictureSources>(std::move(first))), wanted_(all_) {}

    // Asks for the sources of another revision; those that it shares with the one before have the
    // same ids.
    void ask(Sources wanted);
    // What became of the newest ask(): nothing, it is not known yet; "", every renderer can draw
    // the sources; or why one cannot.
    std::optional<std::string> outcome() const;
    // Lets go of sources that were taken away a while ago, so that the end of a video's thread does
    // not hold up the render thread.
    void release();

    // Makes the renderers ready to draw an exchange of a source's pattern. The two newest exchanges
    // of a source are kept.
    void makeReady(show::SourceId source, int number, const render::PatternSource& pattern);

    // What a renderer has been given.
    struct Taken {
        Sources all{};      // it was made for these, or has been given them
        int exchanges = 0;  // the version of the exchanges that it has; 0: none
    };
    // What a new renderer is to be made for. Another thread may read it.
    const Sources& all() const { return all_; }
    // Takes what was asked for, and leaves out what nothing needs at `showTime` and after.
    void beginFrame(const show::Playback& playback, Time showTime);
    // Gives a renderer something that it lacks, unless another one has been given something in this
    // frame. Its context is current. Error: it cannot draw that.
    Result<void> giveTo(render::OutputRenderer& renderer, Taken& taken);
    // All renderers have been asked.
    void endFrame();

private:
    struct Exchange {
        show::SourceId source;
        int number;
        render::PatternSource pattern;
    };
    Result<void> giveSources(render::OutputRenderer& renderer, Taken& taken);
    void answer(const std::string& trouble);

    Sources all_;     // what is wanted, and what is still seen
    Sources wanted_;  // by the newest revision
    LatestValue<Sources> asked_;
    LatestValue<std::vector<Exchange>> exchanges_;
    std::vector<Exchange> made_;  // what was last written there; belongs to the thread that calls makeReady()
    int version_ = 0;             // of what was last read there
    bool isGiven_ = false;        // something, in this frame
    bool isLacked_ = false;       // a source, by a renderer in this frame
    bool isAnswered_ = true;      // the newest ask()
    mutable std::mutex mutex_;    // of:
    std::optional<std::string> outcome_ = "";
    std::vector<std::pair<Sources, Time>> left_;  // and when
    std::atomic<Time> now_{};                     // show time of the newest frame
};

}  // namespace fantascope::app
