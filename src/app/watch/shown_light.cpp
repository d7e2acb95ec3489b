#include "app/watch/shown_light.h"

#include <algorithm>
#include <utility>

namespace fantascope::app {
namespace {

constexpr std::size_t kKept = 24;                            // frames: more than a camera's latency lets wait
constexpr Time kLeastStep = std::chrono::milliseconds(195);  // between the pictures that are looked at
constexpr Time kAhead = std::chrono::milliseconds(80);       // a frame is drawn so long before it is visible;
constexpr double kFramesAhead = 1.5;                         // so many frames on a slow display
constexpr Time kLongestWait = std::chrono::seconds(1);       // for a frame;
constexpr Time kGivesNone = std::chrono::seconds(3);         // an output that gave no frame for so long is not waited for
constexpr Time kTolerance = std::chrono::milliseconds(20);   // for the inaccuracy of both moments,
constexpr double kMostTolerance = 0.5;                       // of a refresh period

Time periodOf(double rate) { return fromSeconds(1 / rate); }

}  // namespace

ShownLight::Frames ShownLight::framesOf(render::NewestFrame& reader) {
    return {[&reader](Time now) { return reader.next(now); }, [&reader](Time showTime) { reader.ask(showTime); }};
}

ShownLight::ShownLight(std::vector<Output> outputs, const vision::WallWatch& wall, const show::ShowClock& showClock)
    : wall_(wall), showClock_(showClock) {
    ahead_ = kAhead;
    for (const Output& output : outputs) {
        outputs_.push_back({output});
        if (output.frames.ask) ahead_ = std::max(ahead_, fromSeconds(kFramesAhead / output.refreshRate));
    }
}

void ShownLight::exposed(Time at, Time period) {
    exposed_ = at;
    period_ = period;
}

void ShownLight::tick(Time now) {
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        Kept& kept = outputs_[i];
        if (!kept.output.frames.next) continue;
        const render::ShownFrame* const frame = kept.output.frames.next(now);
        if (frame == nullptr) continue;
        if (kept.frames.size() >= kKept) kept.frames.pop_front();
        kept.frames.push_back({frame->shown.at, wall_.lightOf(i, frame->image)});
    }
    // The frames of one exposure are drawn before those of the next are asked for.
    if (period_ <= Time{} || now + ahead_ < asked_.back() + period_ / 2) return;
    const Time soonest = std::max(now + ahead_, asked_.back() + kLeastStep);
    const auto steps = soonest > exposed_ ? (soonest - exposed_ + period_ - Time(1)) / period_ : 0;
    asked_.push_back(exposed_ + steps * period_);
    if (asked_.size() > kKept) asked_.pop_front();
    for (const Kept& kept : outputs_)
        if (kept.output.frames.ask)
            kept.output.frames.ask(showClock_.showTime(asked_.back() - periodOf(kept.output.refreshRate) + Time(1)));
}

const GreyImage* ShownLight::at(std::size_t output, Time moment) const {
    const Kept& kept = outputs_[output];
    const Time period = periodOf(kept.output.refreshRate),
               tolerance = std::min(kTolerance, fromSeconds(kMostTolerance * seconds(period)));
    const GreyImage* nearest = nullptr;
    Time least = period / 2 + tolerance;
    for (const Frame& frame : kept.frames) {
        const Time off = frame.visible + period / 2 - moment, distance = off < Time{} ? -off : off;
        if (distance > least) continue;
        least = distance;
        nearest = &frame.light;
    }
    return nearest;
}

bool ShownLight::isComing(Time moment, Time now) const {
    if (now - moment > kLongestWait) return false;
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        const Kept& kept = outputs_[i];
        const Time period = periodOf(kept.output.refreshRate);
        // The frame is the one that was asked for, or the next one where it was asked for too late.
        const auto isOfMoment = [&](Time asked) { return moment > asked - period && moment < asked + 2 * period; };
        const bool isAskedFor = kept.output.frames.ask && std::ranges::any_of(asked_, isOfMoment);
        const bool isExpected =
            !kept.frames.empty() && kept.frames.back().visible <= moment && kept.frames.back().visible > now - kGivesNone;
        if (isAskedFor && isExpected && at(i, moment) == nullptr) return true;
    }
    return false;
}

}  // namespace fantascope::app
