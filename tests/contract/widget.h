#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace fantascope::contract {

// What a widget stores, in its units; factory settings.
struct WidgetSettings {
    std::uint8_t breakTime = 9, markAfterBreak = 1, rate = 40;
};

// Simulates an Enttec DMX USB Pro at the far end of a line. Its protocol code is independent of the
// driver's; tests/peers shows that another program accepts it as a widget.
// Thread: thread-safe.
class Widget {
public:
    using Frame = std::array<std::uint8_t, 512>;
    using Parameters = WidgetSettings;

    // On the open file `line`, which outlives it. `number`: its eight digits; "ffffffff" for none.
    explicit Widget(int line, std::string number = "01234567", Parameters parameters = {});
    ~Widget();

    // Its DMX output: the frame that it repeats, the one that its lamps got last, and how many it
    // was sent.
    std::optional<Frame> out() const;
    std::optional<Frame> lastOut() const;
    int framesOut() const;
    // The first violation of the protocol by the host; "" if none.
    std::string complaint() const;
    Parameters parameters() const;
    int parametersWritten() const;
    bool wasToldToReceive() const;

    // A frame arrives on its DMX line: these slots after a start code. It forwards every frame
    // until it is given one to send.
    void comesIn(std::span<const std::uint8_t> slots, std::uint8_t startCode = 0, std::uint8_t status = 0);
    // It stops answering but reads on; or it stops reading.
    void fallSilent() { silent_ = true; }
    void stopReading() { deaf_ = true; }
    // The state after another program broke off in the middle of a message.
    void hasHeard(std::vector<std::uint8_t> bytes);

private:
    void run();
    bool take();  // the next complete message in heard_; returns whether there was one
    void answer(std::uint8_t label, const std::vector<std::uint8_t>& data);
    void say(std::uint8_t label, const std::vector<std::uint8_t>& data);

    const int line_;
    const std::string number_;
    mutable std::mutex mutex_;
    Parameters parameters_;
    std::vector<std::uint8_t> heard_;
    std::optional<Frame> lastOut_;
    int framesOut_ = 0, written_ = 0;
    bool input_ = true, everyFrame_ = true, toldToReceive_ = false;
    std::string complaint_;
    std::atomic<bool> silent_ = false, deaf_ = false, ending_ = false;
    std::thread thread_;
};

}  // namespace fantascope::contract
