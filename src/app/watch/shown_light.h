#pragma once

#include "render/frame_tap.h"
#include "show/play/show_clock.h"
#include "vision/watch/wall_watch.h"

#include "core/clock.h"
#include "media/image.h"

#include <cstddef>
#include <deque>
#include <functional>
#include <vector>

namespace fantascope::app {

// The light that the projectors gave at the moments when the camera exposed its pictures. It asks
// the outputs for their frames of these moments only, because copying frames is expensive.
// Thread: bound to the vision thread.
class ShownLight {
public:
    // Where an output's frames come from.
    struct Frames {
        // A frame that is or was visible at a moment, each once; null: there is none. Valid until
        // the next call.
        std::function<const render::ShownFrame*(Time now)> next{};
        std::function<void(Time showTime)> ask{};  // requests the frame of a show time
    };
    struct Output {
        Frames frames{};          // empty: this output is not watched
        double refreshRate = 60;  // Hz
    };
    // `reader` was made with rate 0.
    static Frames framesOf(render::NewestFrame& reader);
    // All arguments by reference or pointer outlive this, except `showClock`.
    ShownLight(std::vector<Output> outputs, const vision::WallWatch& wall, const show::ShowClock& showClock);

    // Notes when a picture was exposed. Later pictures are expected at the same steps.
    void exposed(Time at, Time period);
    // Takes the frames that have come, and asks for the next ones.
    void tick(Time now);
    // The light of the frame that was visible at `moment`, by cells; null: it is not known.
    const GreyImage* at(std::size_t output, Time moment) const;
    // Whether the light of `moment` is not known yet, but will be: a frame takes its time from the
    // display to here, and slow displays have slow frames. False once it has taken too long, or if
    // the output gives no frames any more.
    bool isComing(Time moment, Time now) const;

private:
    struct Frame {
        Time visible{};
        GreyImage light;
    };
    struct Kept {
        Output output;
        std::deque<Frame> frames{};  // oldest first
    };
    std::vector<Kept> outputs_;
    const vision::WallWatch& wall_;
    const show::ShowClock showClock_;
    Time ahead_{};                    // how long before it is visible a frame must be asked for
    Time exposed_{}, period_{};       // of the newest picture; the period is 0 until it is known
    std::deque<Time> asked_{Time{}};  // the exposures that frames were asked for last, oldest first; never empty
};

}  // namespace fantascope::app
