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

CapturedFrame* FrameQueue::oldest(Time now) const {
    const std::size_t taken = taken_.load(std::memory_order_relaxed);
    if (taken == given_.load(std::memory_order_acquire)) return nullptr;
    CapturedFrame* const frame = waiting_[taken % waiting_.size()];
    return frame->shown.at > now ? nullptr : frame;
}

std::optional<Time> FrameQueue::nextAt(Time now) {
    const std::lock_guard lock(taking_);
    const CapturedFrame* const frame = oldest(now);
    return frame != nullptr ? std::optional(frame->shown.at) : std::nullopt;
}

const ShownFrame* FrameQueue::newer(Time now) {
    const CapturedFrame* const frame = oldest(now);
    if (frame == nullptr) return nullptr;
    const ShownFrame* const taken = take(*frame);
    taken_.fetch_add(1, std::memory_order_release);
    return taken;
}

void FrameQueue::forget() {
    const std::size_t given = given_;
    missed_ += static_cast<std::int64_t>(given - taken_.exchange(given));
    released_ = given;  // the frames no longer exist
}

void FrameQueue::give(CapturedFrame& frame) {
    for (const std::size_t taken = taken_.load(std::memory_order_acquire); released_ != taken; ++released_)
        release(waiting_[released_ % waiting_.size()]);
    const std::size_t given = given_.load(std::memory_order_relaxed);
    if (given - released_ == waiting_.size()) return miss();
    waiting_[given % waiting_.size()] = hold(&frame);
    given_.store(given + 1, std::memory_order_release);
}

NewestFrame::NewestFrame(const ShownFrame& blank, double rate) : FrameReader(blank) {
    FANTASCOPE_CHECK(rate >= 0, "a frame rate is not negative");
    if (rate > 0)
        interval_ = fromSeconds(1 / rate);
    else
        due_ = Time::max();
}

const ShownFrame* NewestFrame::newer(Time now) {
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
    // Keeps a request that the reader makes at the same moment.
    if (Time::rep asked = asked_; showTime.count() >= asked) asked_.compare_exchange_strong(asked, kNothing);
}

void NewestFrame::forget() {
    for (int buffer = 0; buffer < 3; ++buffer) {  // give() releases what it overwrites
        slot_.writable() = {};
        slot_.publish();
        slot_.update();
    }
    given_ = nullptr;
}

void NewestFrame::give(CapturedFrame& frame) {
    slot_.writable() = {hold(&frame), hold(given_)};
    slot_.publish();
    given_ = &frame;  // the slot or its reader holds it until the next one is given
    release(slot_.writable().frame);
    release(slot_.writable().before);
}

FrameTap::FrameTap(std::size_t output, glm::ivec2 size) : blank_{output, Time{}, Shown{}, RgbaImage(size.x, size.y)} {}

template <class Reader, class... Arguments>
Reader& FrameTap::add(Arguments... arguments) {
    FANTASCOPE_CHECK(captures_ == 0 && readers_.size() < kMaxReaders,
                     "at most kMaxReaders readers are added, before the first frame");
    auto reader = std::make_unique<Reader>(blank_, arguments...);
    Reader& added = *reader;
    readers_.push_back(std::move(reader));
    return added;
}

FrameQueue& FrameTap::addQueue(std::size_t depth) { return add<FrameQueue>(depth); }
NewestFrame& FrameTap::addNewest(double rate) { return add<NewestFrame>(rate); }

std::size_t FrameTap::maxHeld() const {
    std::size_t most = kMaxUnderWay;
    for (const auto& reader : readers_) most += reader->maxHeld();
    return most;
}

Result<void> FrameTap::addFrame() {
    frames_.emplace_back(TRY(gpu::PixelReader::create({blank_.image.width(), blank_.image.height()})));
    return {};
}

Result<void> FrameTap::prepare() {
    while (frames_.size() < maxHeld()) TRY(addFrame());
    return {};
}

void FrameTap::forget() {
    const gpu::Forgetting forgetting;
    for (const auto& reader : readers_) {
        const std::lock_guard lock(reader->taking_);
        reader->forget();
    }
    for (CapturedFrame** lost = underWay_.front(); lost != nullptr; lost = underWay_.front()) {
        for (std::size_t i = 0; i < readers_.size(); ++i)
            if ((*lost)->wanted >> i & 1) readers_[i]->miss();
        underWay_.drop();
    }
    captured_ = nullptr;
    frames_.clear();
}

CapturedFrame* FrameTap::unused() {
    const auto unused = std::ranges::find(frames_, 0, &CapturedFrame::holders);
    if (unused != frames_.end()) return &*unused;
    FANTASCOPE_CHECK(frames_.size() < maxHeld(), "no reader holds more than maxHeld() frames");
    return addFrame() ? &frames_.back() : nullptr;
}

void FrameTap::capture(unsigned framebuffer, Time showTime) {
    captured_ = nullptr;
    missing_ = 0;
    std::uint32_t wanted = 0;
    for (std::size_t i = 0; i < readers_.size(); ++i)
        if (readers_[i]->wants(showTime)) wanted |= std::uint32_t{1} << i;
    if (wanted == 0) return;
    if (underWay_.space() != nullptr) captured_ = unused();
    if (captured_ == nullptr) {
        missing_ = wanted;
        return;
    }
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
    for (std::size_t i = 0; i < readers_.size(); ++i)
        if (missing_ >> i & 1) readers_[i]->miss();
    missing_ = 0;
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
