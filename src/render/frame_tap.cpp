#include "render/frame_tap.h"

#include "core/check.h"

#include <algorithm>
#include <utility>

namespace fantascope::render {
namespace {

void release(CapturedFrame*& frame) {
    if (CapturedFrame* const held = std::exchange(frame, nullptr)) --held->holders;
}

CapturedFrame* hold(CapturedFrame* frame) {
    if (frame != nullptr) ++frame->holders;
    return frame;
}

}  // namespace

const ShownFrame* FrameReader::take(const CapturedFrame& frame) {
    own_.showTime = frame.showTime;
    own_.shown = frame.shown;
    frame.pixels.copyTo(own_.image);
    return &own_;
}

const ShownFrame* FrameQueue::next(Time now) {
    CapturedFrame* const* const oldest = waiting_.front();
    if (oldest == nullptr || (*oldest)->shown.at > now) return nullptr;
    const ShownFrame* const taken = take(**oldest);
    waiting_.drop();
    return taken;
}

void FrameQueue::give(CapturedFrame& frame) {
    CapturedFrame** const place = waiting_.space();
    if (place == nullptr) return;
    release(*place);
    *place = hold(&frame);
    waiting_.push();
}

NewestFrame::NewestFrame(const ShownFrame& blank, double rate) : FrameReader(blank) {
    FANTASCOPE_CHECK(rate >= 0, "frames come forwards");
    if (rate > 0)
        interval_ = fromSeconds(1 / rate);
    else
        due_ = Time::max();
}

const ShownFrame* NewestFrame::next(Time now) {
    slot_.update();
    for (const CapturedFrame* const frame : {slot_.value().frame, slot_.value().before}) {
        if (frame == nullptr || frame->shown.at > now) continue;
        if (frame->number <= taken_) return nullptr;
        taken_ = frame->number;
        return take(*frame);
    }
    return nullptr;
}

bool NewestFrame::wants(Time showTime) const { return showTime >= due_ || showTime.count() >= asked_; }

void NewestFrame::promised(Time showTime) {
    if (showTime >= due_ && interval_ > Time{}) due_ = showTime + interval_;
    // Unless the reader has asked for another one meanwhile.
    if (Time::rep asked = asked_; showTime.count() >= asked) asked_.compare_exchange_strong(asked, kNothing);
}

void NewestFrame::give(CapturedFrame& frame) {
    slot_.writable() = {hold(&frame), hold(given_)};
    slot_.publish();
    given_ = &frame;  // held by the slot or by its reader until the next one is given
    release(slot_.writable().frame);
    release(slot_.writable().before);
}

FrameTap::FrameTap(std::size_t output, glm::ivec2 size) : blank_{output, Time{}, Shown{}, RgbaImage(size.x, size.y)} {}

template <class Reader, class... Arguments>
Reader& FrameTap::add(Arguments... arguments) {
    FANTASCOPE_CHECK(captures_ == 0 && readers_.size() < kMostReaders, "readers come before the first frame, and are few");
    auto reader = std::make_unique<Reader>(blank_, arguments...);
    Reader& added = *reader;
    readers_.push_back(std::move(reader));
    return added;
}

FrameQueue& FrameTap::addQueue() { return add<FrameQueue>(); }
NewestFrame& FrameTap::addNewest(double rate) { return add<NewestFrame>(rate); }

void FrameTap::prepare() {
    while (frames_.size() < readers_.size() * kMostHeld + kMostUnderWay)
        frames_.emplace_back(glm::ivec2(blank_.image.width(), blank_.image.height()));
}

CapturedFrame& FrameTap::unused() {
    const auto unused = std::ranges::find(frames_, 0, &CapturedFrame::holders);
    if (unused != frames_.end()) return *unused;
    FANTASCOPE_CHECK(frames_.size() < readers_.size() * kMostHeld + kMostUnderWay, "no reader holds more than its share");
    return frames_.emplace_back(glm::ivec2(blank_.image.width(), blank_.image.height()));
}

void FrameTap::capture(unsigned framebuffer, Time showTime) {
    captured_ = nullptr;
    std::uint32_t wanted = 0;
    for (std::size_t i = 0; i < readers_.size(); ++i)
        if (readers_[i]->wants(showTime)) wanted |= std::uint32_t{1} << i;
    if (wanted == 0 || underWay_.space() == nullptr) return;
    captured_ = &unused();
    captured_->number = captures_++;
    captured_->showTime = showTime;
    captured_->wanted = wanted;
    captured_->pixels.start(framebuffer);
}

void FrameTap::publish(const Shown& shown) {
    if (captured_ != nullptr) {
        captured_->shown = shown;
        for (std::size_t i = 0; i < readers_.size(); ++i)
            if (captured_->wanted >> i & 1) readers_[i]->promised(captured_->showTime);
        underWay_.push(hold(std::exchange(captured_, nullptr)));
    }
    while (CapturedFrame** const oldest = underWay_.front()) {
        if (!(*oldest)->pixels.finished()) break;
        handOut(**oldest);
    }
}

void FrameTap::finish() {
    while (CapturedFrame** const oldest = underWay_.front()) {
        (*oldest)->pixels.wait();
        handOut(**oldest);
    }
}

void FrameTap::handOut(CapturedFrame& frame) {
    for (std::size_t i = 0; i < readers_.size(); ++i)
        if (frame.wanted >> i & 1) readers_[i]->give(frame);
    --frame.holders;
    underWay_.drop();
}

}  // namespace fantascope::render
