#pragma once
// Cameras that a program under umockdev sees where the kernel has none: the driver's own system
// calls arrive at a MockCamera. What it cannot mimic is poll(): a node is a file, which is always
// ready. So a camera without a frame answers a little late, as if the wait had been there.

#include "core/clock.h"
#include "mock_machine.h"

#include <glm/vec2.hpp>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

struct _UMockdevIoctlBase;
struct _UMockdevIoctlClient;

namespace fantascope {

// What a camera is and grants. Formats are V4L2's four letters.
struct MockCameraKind {
    std::string card = "Mock Camera", serial = "", usb = "1-1";
    std::vector<std::string> formats{"YUYV"};
    std::map<std::string, double> rates = {};  // Hz that it grants in a format at the most; 30 where nothing stands
    glm::ivec2 size{64, 48};                   // all that it grants
    unsigned padding = 0;                      // bytes at the end of each row
    bool saysStride = true;
    bool fullRange = false;
    bool captures = true;                     // else it is a node of metadata
    std::optional<std::string> answers = {};  // this format, whatever it is asked for
    struct Range {
        int least, most, now;
    };
    std::map<std::uint32_t, Range> controls = {};
    std::uint32_t stampFlags = 0x2000;  // V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC, at the end of the frame
};

class MockCamera {
public:
    MockCamera(MockMachine& machine, MockCameraKind kind);
    ~MockCamera();
    MockCamera(const MockCamera&) = delete;
    MockCamera& operator=(const MockCamera&) = delete;

    // As /dev/videoNUMBER, one that was not there before.
    void plugIn(int number);
    void unplug();
    const MockCameraKind& kind() const { return kind_; }
    std::filesystem::path file() const;  // as a program sees it

    // The camera has a frame now. It is dropped, and counted, if nobody has left a buffer for it.
    struct Frame {
        std::vector<std::uint8_t> bytes;
        bool damaged = false;            // flagged so
        std::optional<Time> stamp = {};  // kernelTime() of now
        std::uint32_t skipped = 0;       // how many the camera drops before it
    };
    void send(const Frame& frame);
    // Waits until the driver has taken all of them and has come back for more, which is when their
    // pictures can be seen. False: it does not.
    bool waitUntilTaken();

    void setBusy(bool busy);                       // another program has it
    void failTaking(int error);                    // errno of every further take; 0: no more
    std::optional<int> control(std::uint32_t id);  // its value
    std::string format();                          // that is set
    int streams();                                 // how often a stream was started
    bool waitForStreams(int count);                // until so many were started. False: they are not

private:
    struct Node;
    int answer(std::uint32_t request, void* argument);
    static int handle(_UMockdevIoctlBase*, _UMockdevIoctlClient* client, void* self);
    void deliver();

    MockMachine& machine_;
    const MockCameraKind kind_;
    int number_ = -1;
    std::string parent_;  // its place in /sys
    _UMockdevIoctlBase* handler_ = nullptr;
    std::vector<std::filesystem::path> answered_;  // every file that it was

    std::mutex mutex_;
    std::condition_variable changed_;
    int memory_ = -1;  // the node's file
    bool plugged_ = false, busy_ = false, streaming_ = false;
    bool idle_ = false;     // the driver has come back and found nothing
    bool settled_ = false;  // it was told so since the last frame
    int takingFails_ = 0, streams_ = 0;
    std::string format_;
    std::map<std::uint32_t, MockCameraKind::Range> controls_;
    std::deque<unsigned> empty_;  // buffers
    struct Filled {
        unsigned index;
        std::uint32_t bytes, sequence, flags;
        Time stamp;
    };
    std::deque<Filled> filled_;
    std::uint32_t sequence_ = 0;
};

}  // namespace fantascope
