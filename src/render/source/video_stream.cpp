#include "render/source/video_stream.h"

#include "core/log.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <utility>

namespace fantascope::render {
namespace {

// The cost of a seek, in frames that could be decoded in the same time.
constexpr std::uint32_t kSeekCost = 8;
// After an exception: how long decoding rests if no frame is known to be wanted, and when the
// frames that failed are tried again.
constexpr Time kRest = std::chrono::milliseconds(10), kRetry = std::chrono::seconds(1);

}  // namespace

Result<std::shared_ptr<VideoStream>> VideoStream::open(const std::filesystem::path& file, Pace pace, Time from) {
    auto content = TRY(VideoDecoder::examine(file));
    if (from >= content->length)
        return Error(fmt::format("{}: it is {:.3f} s long, so it cannot begin at {:.3f} s", file.string(),
                                 seconds(content->length), seconds(from)));
    auto decoder = TRY(VideoDecoder::open(content));
    const auto first = decoder->next();
    if (first.value_or(kOpening) >= kOpening)
        return Error(
            fmt::format("{}: its first frame cannot be decoded; copy the file again, or export it again", file.string()));
    return std::shared_ptr<VideoStream>(new VideoStream(std::move(content), std::move(decoder), *first, pace, from));
}

VideoStream::VideoStream(std::shared_ptr<const VideoContent> content, std::unique_ptr<VideoDecoder> decoder,
                         std::uint32_t decoded, Pace pace, Time from)
    : content_(std::move(content)), pace_(pace), opening_(content_->frameAt(from)) {
    asked_.reserve(kMaxMoments);
    wanted_.reserve(kSlots);
    findWanted();
    publish(decoded, decoder.get());
    playheads_.push_back({.decoder = std::move(decoder), .next = decoded + 1});
    thread_ = std::thread([this] { run(); });
}

VideoStream::~VideoStream() {
    ended_ = true;
    wake();
    thread_.join();
}

void VideoStream::wake() {
    wishes_.fetch_add(1, std::memory_order_release);
    wishes_.notify_one();
}

// The decoding thread.

void VideoStream::run() {
    while (!ended_) {
        const std::uint32_t wishes = wishes_.load(std::memory_order_acquire);
        std::optional<std::uint32_t> frame;
        try {
            findWanted();
            frame = missing();
            if (frame)
                fetch(*frame);
            else if (clock_.now() >= retryAt_)
                retry();
            else
                wishes_.wait(wishes, std::memory_order_acquire);
        } catch (const std::exception& failure) {
            leaveOut(frame, failure.what());
        }
    }
}

// A frame whose decoding fails by an exception is a damaged one for now. No frame: it failed before
// one was chosen.
void VideoStream::leaveOut(std::optional<std::uint32_t> frame, const char* why) {
    retryAt_ = clock_.now() + kRetry;
    if (!frame)
        clock_.sleepUntil(clock_.now() + kRest);
    else if (!has(*frame))
        publish(*frame, nullptr);
    if (std::exchange(failureTold_, true)) return;
    try {
        log::warning("render", fmt::format("{}: a frame cannot be decoded: {}; it is left out", content_->file.string(), why));
    } catch (const std::exception&) {  // no memory for the message either
        failureTold_ = false;
    }
}

// The opening is always wanted, so its damaged frames would stay damaged for good.
void VideoStream::retry() {
    retryAt_ = Time::max();
    for (Slot& slot : slots_)
        if (const Tag tag = slot.tag; tag.state == State::Damaged) slot.change(tag, State::Free);
}

std::optional<std::uint32_t> VideoStream::missing() const {
    const auto frame = std::ranges::find_if(wanted_, [&](std::uint32_t wanted) { return !has(wanted); });
    return frame == wanted_.end() ? std::nullopt : std::optional(*frame);
}

void VideoStream::findWanted() {
    asked_.clear();
    {
        const std::lock_guard lock(mutex_);
        for (const auto& reader : readers_) asked_.push_back(reader->load(std::memory_order_relaxed));
    }
    wanted_.clear();
    const auto count = static_cast<std::uint32_t>(content_->frames.size());
    const auto want = [&](std::uint32_t frame) {
        if (!wanted(frame) && wanted_.size() < kSlots - kSpare) wanted_.push_back(frame);
    };
    for (std::uint32_t ahead = 0; ahead < kAhead; ++ahead)
        for (const std::uint32_t asked : asked_) want((asked + ahead) % count);
    for (std::uint32_t frame = 0; frame < kOpening; ++frame) want((opening_ + frame) % count);
}

bool VideoStream::wanted(std::uint32_t frame) const { return std::ranges::find(wanted_, frame) != wanted_.end(); }

bool VideoStream::has(std::uint32_t frame) const {
    const auto holds = [&](const Slot& slot) {
        const Tag tag = slot.tag;
        return tag.state != State::Free && tag.frame == frame;
    };
    return std::ranges::any_of(slots_, holds);
}

// Decodes one frame on the way to `frame`.
void VideoStream::fetch(std::uint32_t frame) {
    Playhead& head = playheadFor(frame);
    head.used = ++steps_;
    if (frame < head.target || frame > head.target + kAhead) head.from = frame;  // the readers have jumped
    head.target = frame;
    const auto number = head.decoder->next();
    if (!damageTold_ && !head.decoder->damage().empty()) {
        damageTold_ = true;
        log::warning("render", head.decoder->damage() + "; damaged frames are skipped from now on");
    }
    // Frames that were skipped are damaged.
    const auto end = number.value_or(static_cast<std::uint32_t>(content_->frames.size()));
    for (const std::uint32_t passed : wanted_)
        if (passed >= head.next && passed < end && !has(passed)) publish(passed, nullptr);
    head.next = end;
    if (!number) return;
    head.next = *number + 1;
    // A frame that the readers have passed in the meantime is still better than an older one.
    const bool late = *number >= head.from && *number < frame;
    if ((late || wanted(*number)) && !has(*number)) publish(*number, head.decoder.get());
}

// The decoder that reaches a frame soonest.
VideoStream::Playhead& VideoStream::playheadFor(std::uint32_t frame) {
    const auto distance = [&](const Playhead& head) { return head.next <= frame ? frame - head.next : std::uint32_t{~0u}; };
    const auto nearest = std::ranges::min_element(playheads_, {}, distance);
    if (distance(*nearest) <= kSeekCost + frame - content_->frames[frame].entry) return *nearest;

    auto rested = std::ranges::min_element(playheads_, {}, &Playhead::used);
    if (playheads_.size() < moments())
        if (auto further = VideoDecoder::open(content_)) {
            playheads_.push_back({.decoder = std::move(*further)});
            rested = std::prev(playheads_.end());
        }
    rested->decoder->seek(frame);
    rested->next = content_->frames[frame].entry;
    return *rested;
}

// How many moments are asked for that are too far apart for one decoder.
std::size_t VideoStream::moments() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < asked_.size(); ++i) {
        const auto near = [&](std::uint32_t other) { return std::max(other, asked_[i]) - std::min(other, asked_[i]) <= kAhead; };
        if (std::none_of(asked_.begin(), asked_.begin() + static_cast<std::ptrdiff_t>(i), near)) ++count;
    }
    return std::min(count, kMaxMoments);
}

// A slot that is not needed; null only while readers hold all such slots.
VideoStream::Slot* VideoStream::reclaim() {
    for (Slot& slot : slots_) {
        const Tag tag = slot.tag;
        if (tag.state == State::Free) return &slot;
        if (tag.state != State::InUse && !wanted(tag.frame) && slot.change(tag, State::Free)) return &slot;
    }
    return nullptr;
}

// Publishes the frame that `decoder` has decoded; null: that the frame is damaged.
void VideoStream::publish(std::uint32_t frame, VideoDecoder* decoder) {
    Slot* const slot = reclaim();
    if (slot == nullptr) return;
    if (decoder != nullptr) {
        if (slot->picture.empty()) slot->picture = RgbaImage(content_->size.x, content_->size.y);
        decoder->picture(slot->picture);
    }
    slot->set(decoder != nullptr ? State::Ready : State::Damaged, frame);
    published_.fetch_add(1, std::memory_order_release);
    published_.notify_all();
}

// The readers' thread.

VideoStream::Reader::Reader(std::shared_ptr<VideoStream> stream)
    : stream_(std::move(stream)), asked_(std::make_shared<Asked>(stream_->opening_)) {
    const std::lock_guard lock(stream_->mutex_);
    stream_->readers_.push_back(asked_);
}

VideoStream::Reader::~Reader() {
    if (stream_ == nullptr) return;
    const std::lock_guard lock(stream_->mutex_);
    std::erase(stream_->readers_, asked_);
}

VideoStream::Slot* VideoStream::Reader::take(Time position) {
    VideoStream& stream = *stream_;
    const std::uint32_t frame = stream.content_->frameAt(position);
    if (asked_->exchange(frame, std::memory_order_relaxed) != frame) {
        late_ = damaged_ = false;
        stream.wake();
    }
    if (shown_ == frame) return nullptr;
    const auto count = static_cast<std::uint32_t>(stream.content_->frames.size());
    const auto lag = [&](std::uint32_t other) { return (frame + count - other) % count; };
    for (;;) {
        const std::uint32_t published = stream.published_.load(std::memory_order_acquire);
        // The frame itself, else the nearest one before it, if that is nearer than the one shown.
        std::uint32_t smallest = shown_ ? lag(*shown_) : count;
        Slot* nearest = nullptr;
        for (Slot& slot : stream.slots_) {
            const Tag tag = slot.tag;
            if (tag == Tag{State::Damaged, frame}) {
                if (!std::exchange(damaged_, true)) ++stream.damagedFrames_;
                return nullptr;
            }
            if (tag.state != State::Ready || lag(tag.frame) >= smallest) continue;
            smallest = lag(tag.frame);
            nearest = &slot;
        }
        const bool there = nearest != nullptr && smallest == 0;
        const std::uint32_t number = (frame + count - smallest) % count;
        if (stream.pace_ == Pace::Live && !there && !std::exchange(late_, true)) ++stream.lateFrames_;
        if (there || (nearest != nullptr && stream.pace_ == Pace::Live)) {
            // The decoding thread may be reusing the slot at this moment.
            if (nearest->change({State::Ready, number}, State::InUse)) {
                shown_ = number;
                return nearest;
            }
        }
        if (stream.pace_ == Pace::Live) return nullptr;
        if (!there) stream.published_.wait(published, std::memory_order_acquire);
    }
}

}  // namespace fantascope::render
