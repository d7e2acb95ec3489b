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

// The frames of a video, decoded ahead on a thread of its own for all outputs that show it. Whoever
// shows it asks for a moment of the video; where outputs ask for different moments, as when it
// began earlier on one of them, each has a decoder.
//
// Frames are kept as RGBA, 4 bytes a pixel: kOpening of the beginning, kAhead for every moment that
// is asked for, and kSpare; for one moment and 1920 x 1080 some 100 MB. A video that begins, begins
// again or comes round shows its opening at once while the rest is fetched. A frame that cannot be
// decoded is left out: the one before it stays.
class VideoStream {
public:
    // What is to be done about a frame that is not decoded yet.
    enum class Pace {
        Live,  // the one before it stays, and it counts as late: the show goes on
        Exact  // it is waited for, so that the same moments always show the same
    };

    // Decodes the first frame. Error: as VideoDecoder::examine(); the first frame cannot be
    // decoded.
    static Result<std::shared_ptr<VideoStream>> open(const std::filesystem::path& file, Pace pace);
    ~VideoStream();

    const VideoContent& content() const { return *content_; }
    // How often a frame was not there in time, over all readers. Thread-safe.
    std::int64_t lateFrames() const { return lateFrames_; }
    // How often one was asked for of which there is no picture, over all readers. Thread-safe.
    std::int64_t damagedFrames() const { return damagedFrames_; }

private:
    enum class State : std::uint32_t { Free, Ready, Damaged, InUse };  // Damaged: there is no picture of it
    struct Tag {
        State state = State::Free;
        std::uint32_t frame = 0;  // its number
        friend bool operator==(const Tag&, const Tag&) = default;
    };
    // A frame in memory: the decoding thread's while Free, of the reader who made it so while
    // InUse.
    struct Slot {
        std::atomic<Tag> tag;
        RgbaImage picture;

        bool change(Tag from, State to) { return tag.compare_exchange_strong(from, {to, from.frame}, std::memory_order_acquire); }
        void set(State state, std::uint32_t frame) { tag.store({state, frame}, std::memory_order_release); }
    };
    using Asked = std::atomic<std::uint32_t>;  // a frame's number

public:
    // One output's view of the video. Thread: all readers of a stream are bound to one thread. At
    // Pace::Live it never blocks, but while it is made and destroyed.
    class Reader {
    public:
        explicit Reader(std::shared_ptr<VideoStream> stream);
        ~Reader();
        Reader(Reader&& other) = default;

        // Calls show(picture) with what is to be seen at `position`, 0 <= position < length, unless
        // that was shown the last time. Colours are multiplied by alpha, as premultiply() does.
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
        bool late_ = false, damaged_ = false;  // what is asked for was counted as such
    };

private:
    static constexpr std::size_t kOpening = 4, kAhead = 6, kSpare = 2;
    static constexpr std::size_t kMostMoments = 8;  // of more only the next frames are fetched
    static constexpr std::size_t kSlots = kOpening + kMostMoments * kAhead + kSpare;

    // A decoder on its way through the file.
    struct Playhead {
        std::unique_ptr<VideoDecoder> decoder;
        std::uint32_t next = 0;    // the frame that it gives next
        std::uint32_t target = 0;  // what it was last on its way to
        std::uint32_t from = 0;    // before it lies only what is needed to get there
        std::uint64_t used = 0;    // when, in steps of fetch()
    };

    VideoStream(std::shared_ptr<const VideoContent> content, std::unique_ptr<VideoDecoder> decoder, std::uint32_t decoded,
                Pace pace);
    void run();
    void findWanted();
    void fetch(std::uint32_t frame);
    void fetchOrLeaveOut(std::uint32_t frame);
    Playhead& playheadFor(std::uint32_t frame);
    bool wanted(std::uint32_t frame) const;
    bool has(std::uint32_t frame) const;
    Slot* reclaim();
    void publish(std::uint32_t frame, VideoDecoder* decoder);
    std::size_t moments() const;
    void wake();

    const std::shared_ptr<const VideoContent> content_;
    const Pace pace_;
    std::array<Slot, kSlots> slots_;
    std::atomic<std::uint32_t> wishes_ = 0, published_ = 0;  // counters to wait on
    std::atomic<std::int64_t> lateFrames_ = 0, damagedFrames_ = 0;
    std::mutex mutex_;
    std::vector<std::shared_ptr<Asked>> readers_;  // under mutex_

    // The decoding thread's.
    std::vector<Playhead> playheads_;
    std::vector<std::uint32_t> asked_;   // by each reader
    std::vector<std::uint32_t> wanted_;  // the most urgent first
    std::uint64_t steps_ = 0;
    bool damageTold_ = false, failureTold_ = false;

    std::atomic<bool> ended_ = false;
    std::thread thread_;
};

}  // namespace fantascope::render
