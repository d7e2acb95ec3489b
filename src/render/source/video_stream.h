#pragma once

#include "render/source/video_decoder.h"

#include "core/clock.h"
#include "core/result.h"
#include "media/image.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace fantascope::render {

// The frames of a video, decoded ahead on a thread of its own for all outputs that show it. An
// output asks for a moment of the video. If outputs ask for different moments, as when the video
// began earlier on one of them, each gets its own decoder.
//
// Frames are kept as RGBA, 4 bytes per pixel: kOpening from where it begins, kAhead for every
// moment asked for, and kSpare; some 100 MB for one moment of 1920 x 1080. A video that begins,
// restarts or loops shows its opening at once while further frames are decoded. If a frame cannot
// be decoded, the one before it stays.
class VideoStream {
public:
    // What happens if a frame is not decoded in time.
    enum class Pace {
        Live,  // the one before it stays, and the frame counts as late: the show goes on
        Exact  // wait for it, so that the same moments always show the same frames
    };

    // Opens a video and decodes its first frame. `from`: where it begins to play. Error: as
    // VideoDecoder::examine(), or the first frame cannot be decoded, or the video is over by then.
    static Result<std::shared_ptr<VideoStream>> open(const std::filesystem::path& file, Pace pace, Time from = {});
    ~VideoStream();

    const VideoContent& content() const { return *content_; }
    // How often a frame was not decoded in time, over all readers. Thread-safe.
    std::int64_t lateFrames() const { return lateFrames_; }
    // How often a frame was asked for that cannot be decoded, over all readers. Thread-safe.
    std::int64_t damagedFrames() const { return damagedFrames_; }

private:
    enum class State : std::uint32_t { Free, Ready, Damaged, InUse };  // Damaged: it cannot be decoded
    struct Tag {
        State state = State::Free;
        std::uint32_t frame = 0;  // its number
        friend bool operator==(const Tag&, const Tag&) = default;
    };
    // A frame in memory. While Free it belongs to the decoding thread, while InUse to the reader
    // that set it so.
    struct Slot {
        std::atomic<Tag> tag;
        RgbaImage picture;

        bool change(Tag from, State to) { return tag.compare_exchange_strong(from, {to, from.frame}, std::memory_order_acquire); }
        void set(State state, std::uint32_t frame) { tag.store({state, frame}, std::memory_order_release); }
    };
    using Asked = std::atomic<std::uint32_t>;  // a frame's number

public:
    // One output's view of the video. Thread: all readers of a stream are bound to one thread. At
    // Pace::Live, only construction and destruction may block.
    class Reader {
    public:
        explicit Reader(std::shared_ptr<VideoStream> stream);
        ~Reader();
        Reader(Reader&& other) = default;

        // Calls show(picture) with the frame of `position`, 0 <= position < length, unless the last
        // call showed it already. Colours are multiplied by alpha, as by premultiply().
        template <class Show>
        void at(Time position, Show show) {
            Slot* const slot = take(position);
            if (slot == nullptr) return;
            show(std::as_const(slot->picture));
            slot->set(State::Ready, *shown_);
        }

    private:
        Slot* take(Time position);

        std::shared_ptr<VideoStream> stream_;
        std::shared_ptr<Asked> asked_;
        std::optional<std::uint32_t> shown_;
        bool late_ = false, damaged_ = false;  // the frame asked for was counted as such
    };

private:
    static constexpr std::size_t kOpening = 4, kAhead = 6, kSpare = 2;
    static constexpr std::size_t kMaxMoments = 8;  // with more of them, fewer frames ahead of each are decoded
    static constexpr std::size_t kSlots = kOpening + kMaxMoments * kAhead + kSpare;

    // A decoder on its way through the file.
    struct Playhead {
        std::unique_ptr<VideoDecoder> decoder;
        std::uint32_t next = 0;    // the next frame it will decode
        std::uint32_t target = 0;  // the frame it was last heading for
        std::uint32_t from = 0;    // frames before it are decoded only to get there
        std::uint64_t used = 0;    // when it was last used, in calls of fetch()
    };

    VideoStream(std::shared_ptr<const VideoContent> content, std::unique_ptr<VideoDecoder> decoder, std::uint32_t decoded,
                Pace pace, Time from);
    void run();
    void findWanted();
    void fetch(std::uint32_t frame);
    std::optional<std::uint32_t> missing() const;
    void leaveOut(std::optional<std::uint32_t> frame, const char* why);
    void retry();
    Playhead& playheadFor(std::uint32_t frame);
    bool wanted(std::uint32_t frame) const;
    bool has(std::uint32_t frame) const;
    Slot* reclaim();
    void publish(std::uint32_t frame, VideoDecoder* decoder);
    std::size_t moments() const;
    void wake();

    const std::shared_ptr<const VideoContent> content_;
    const Pace pace_;
    const std::uint32_t opening_;  // the first frame of what plays
    std::array<Slot, kSlots> slots_;
    std::atomic<std::uint32_t> wishes_ = 0, published_ = 0;  // counters that threads wait on
    std::atomic<std::int64_t> lateFrames_ = 0, damagedFrames_ = 0;
    std::mutex mutex_;
    std::vector<std::shared_ptr<Asked>> readers_;  // under mutex_

    // For the decoding thread only.
    std::vector<Playhead> playheads_;
    std::vector<std::uint32_t> asked_;   // by each reader
    std::vector<std::uint32_t> wanted_;  // the most urgent first
    std::uint64_t steps_ = 0;
    bool damageTold_ = false, failureTold_ = false;
    SteadyClock clock_;
    Time retryAt_ = Time::max();  // when frames that failed by an exception are tried again

    std::atomic<bool> ended_ = false;
    std::thread thread_;
};

}  // namespace fantascope::render
