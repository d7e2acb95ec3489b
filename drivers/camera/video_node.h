#pragma once

#include "drivers/camera/frame_decoder.h"
#include "drivers/common/file_handle.h"

#include "core/clock.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::drivers {

// An open capture node of the kernel (V4L2), such as /dev/video0: requests, and what is really
// granted. Functions return the errno of the failing call; 0 is success.
// Thread: thread-bound.
class VideoNode {
public:
    // Opens a node. `error`: 0, or why not; ENOTSUP: it does not capture (cameras have metadata
    // nodes, too).
    static std::optional<VideoNode> open(const std::filesystem::path& path, int& error);
    VideoNode(VideoNode&&) = default;
    VideoNode& operator=(VideoNode&&) = default;

    const std::string& card() const { return card_; }  // "HD Webcam C525"
    int file() const { return file_.get(); }           // readable when there is a frame
    bool isInUse() const;                              // by another program

    // The formats that can be decoded here, and the names of the others.
    struct Offer {
        std::vector<FrameCoding> codings;
        std::vector<std::string> others;
    };
    Offer offer() const;

    struct Grant {
        FrameFormat format;
        double rate = 0;  // Hz; 0: unknown
    };
    // Requests a format and returns what is granted: drivers change size and rate rather than
    // refuse. ENOTSUP: it granted another coding.
    int setFormat(FrameCoding coding, glm::ivec2 size, double rate, Grant& grant);

    // The supported V4L2 controls. A camera may change any of them by itself unless its automatic
    // mode is off.
    enum class Control { Exposure, Gain, WhiteBalance, Focus };
    enum class Outcome { Done, Changed, Missing };  // Changed: to another value than requested
    // Sets a control; without a value, switches its automatic mode on. `value` becomes the value in
    // force.
    Outcome set(Control control, std::optional<std::int64_t>& value);
    // The exposure time, if it is locked and known.
    std::optional<Time> lockedExposure() const;

    // Starts streaming, with all buffers queued.
    int start();
    int restart();  // frames that were not taken are lost
    // Whether its memory is mapped through DMABUFs; after start(), if the driver offers them.
    bool sharesDmabufs() const { return !memories_.empty() && memories_.front().isDmabuf(); }

    struct Buffer {
        unsigned index = 0;
        std::span<const std::uint8_t> bytes;
        bool damaged = false;         // as flagged by the driver
        std::uint32_t sequence = 0;   // the driver's count
        std::optional<Time> stamp;    // on kernelTime(), if the driver uses that clock
        bool stampedAtStart = false;  // stamped at the exposure's start; else at the frame's end
    };
    // EAGAIN: no frame yet. A taken buffer must be returned by requeue() and not be read after
    // that.
    int take(Buffer& buffer);
    int requeue(unsigned index);

private:
    // A mapping of a buffer's memory. Through a DMABUF, its caches are synchronised around each
    // read: a driver that shares memory with other devices need not do so by itself.
    class Memory {
    public:
        // `dmabuf`: the buffer's, if the driver exports it and this kernel can map it, else closed;
        // then `node` is mapped at `offset`.
        Memory(FileHandle dmabuf, int node, std::size_t length, std::int64_t offset);
        ~Memory();
        Memory(Memory&& other) noexcept : dmabuf_(std::move(other.dmabuf_)), bytes_(std::exchange(other.bytes_, {})) {}
        Memory& operator=(Memory&&) = delete;
        std::span<const std::uint8_t> bytes() const { return bytes_; }  // empty if mapping failed
        bool isDmabuf() const { return dmabuf_.isOpen(); }
        void beginReading() const;
        void endReading() const;

    private:
        FileHandle dmabuf_;
        std::span<std::uint8_t> bytes_;
    };

    VideoNode(FileHandle file, std::string card, bool planar) : file_(std::move(file)), card_(std::move(card)), planar_(planar) {}
    int call(unsigned long request, void* argument) const;
    unsigned type() const;
    FileHandle dmabufOf(unsigned index) const;
    int queue(unsigned index);

    FileHandle file_;
    std::string card_;
    bool planar_;  // uses the multi-planar API
    std::vector<Memory> memories_;
};

}  // namespace fantascope::drivers
