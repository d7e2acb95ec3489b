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

// An open video node of the kernel (V4L2), such as /dev/video0, one that captures: how it is asked,
// and what it really grants. What fails gives the errno of the failing call, 0 being success.
// Thread: thread-bound.
class VideoNode {
public:
    // Opens a node. `error`: 0, or why not; ENOTSUP says that it does not capture (a camera has
    // nodes for its metadata, too).
    static std::optional<VideoNode> open(const std::filesystem::path& path, int& error);
    VideoNode(VideoNode&&) = default;
    VideoNode& operator=(VideoNode&&) = default;

    const std::string& card() const { return card_; }  // "HD Webcam C525"
    int file() const { return file_.get(); }           // readable when there is a frame
    bool isTaken() const;                              // by another program

    // What it offers that can be decoded here, and its names of what cannot.
    struct Offer {
        std::vector<FrameCoding> codings;
        std::vector<std::string> others;
    };
    Offer offer() const;

    struct Grant {
        FrameFormat format;
        double rate = 0;  // Hz; 0: it does not say
    };
    // Asks for a coding, and tells what is granted: drivers answer with another size or rate rather
    // than refuse. ENOTSUP: it answered with another coding.
    int ask(FrameCoding coding, glm::ivec2 size, double rate, Grant& grant);

    // The controls of V4L2 that are named here; by itself a camera may change what it is not told
    // to leave alone.
    enum class Control { Exposure, Gain, WhiteBalance, Focus };
    enum class Outcome { Done, Changed, Missing };  // Changed: another value than asked
    // Sets a control, or hands it over to the camera's own automatism without a value. `value`
    // becomes what is in force.
    Outcome set(Control control, std::optional<std::int64_t>& value);
    // How long it exposes, where that is locked and known.
    std::optional<Time> lockedExposure() const;

    // Streams, with all buffers waiting for frames.
    int start();
    int restart();  // what was not taken yet is gone
    // Whether its memory is seen as DMABUFs: since start(), where the driver offers them.
    bool sharesDmabufs() const { return !memories_.empty() && memories_.front().isDmabuf(); }

    struct Buffer {
        unsigned index = 0;
        std::span<const std::uint8_t> bytes;
        bool damaged = false;         // the driver says so
        std::uint32_t sequence = 0;   // as the driver counts
        std::optional<Time> stamp;    // kernelTime(), where the driver stamps by it
        bool stampedAtStart = false;  // of the exposure; else when the frame ended
    };
    // EAGAIN: no frame has come yet. What is taken must be given back, and is not read after that.
    int take(Buffer& buffer);
    int giveBack(unsigned index);

private:
    // What the kernel's memory of a buffer is seen by. As a DMABUF, its caches are made to agree
    // with the device's around each reading: a driver that shares memory with other devices need
    // not do so by itself.
    class Memory {
    public:
        // `dmabuf`: the buffer's, if the driver exports it and this kernel lets it be read, closed
        // otherwise; then the driver's `node` is mapped at `offset`.
        Memory(FileHandle dmabuf, int node, std::size_t length, std::int64_t offset);
        ~Memory();
        Memory(Memory&& other) noexcept : dmabuf_(std::move(other.dmabuf_)), bytes_(std::exchange(other.bytes_, {})) {}
        Memory& operator=(Memory&&) = delete;
        std::span<const std::uint8_t> bytes() const { return bytes_; }  // empty if it cannot be seen
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
    bool planar_;  // it speaks the multi-planar variant of the interface
    std::vector<Memory> memories_;
};

}  // namespace fantascope::drivers
