#pragma once

#include "drivers/dmx/enttec_message.h"

#include "device/byte_stream.h"

#include "core/clock.h"
#include "core/result.h"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace fantascope::drivers {

// Talks to a widget during one life of its line. Errors of all methods: the line is lost, the
// widget accepts nothing for kStalled, or it does not answer. Thread: bound to that of the line.
class EnttecWidget {
public:
    static constexpr Time kStalled = std::chrono::seconds(1);        // a widget that accepts no byte for so long is stuck
    static constexpr Time kAskEvery = std::chrono::seconds(1);       // whether it is still there
    static constexpr Time kAnswerTimeout = std::chrono::seconds(2);  // then it has stopped answering

    EnttecWidget(ByteStream& line, Clock& clock) : line_(line), clock_(clock), progress_(clock.now()), asked_(clock.now()) {}

    // Requests the parameters: only a widget answers.
    Result<WidgetParameters> handshake();
    // The eight digits of its own serial number; "" if it has none.
    Result<std::string> number();
    // Writes the parameters if they differ, and verifies that it accepted them.
    Result<void> setParameters(const WidgetParameters& wanted);
    // Its name; "" if it does not know one. The request ends its output.
    Result<std::string> name();

    // Queues a message for work().
    void queue(WidgetLabel label, std::span<const std::uint8_t> data);
    // Whether all queued messages have been sent.
    bool idle() const { return outgoing_.empty(); }
    // Sends queued messages and receives until `until`. Once a second it checks that the widget is
    // still there, with the one request that does not end its output.
    Result<void> work(Time until, const std::function<void(const WidgetMessage&)>& onMessage);

private:
    using Data = std::vector<std::uint8_t>;
    Result<std::optional<Data>> answer(WidgetLabel label, std::span<const std::uint8_t> question, Time timeout);
    Result<void> writeSome();  // as much as the line accepts
    Result<void> readSome(Time timeout);

    ByteStream& line_;
    Clock& clock_;
    WidgetParser parser_;
    Data outgoing_;
    Time progress_;  // when the line last accepted a byte, or had nothing to send
    Time asked_;
    bool answered_ = true;
};

}  // namespace fantascope::drivers
