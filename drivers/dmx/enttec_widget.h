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

// A conversation with a widget, over one life of its line. Errors of all: the line is lost, or the
// widget takes nothing for kStalled, or does not answer. Thread: bound to that of the line.
class EnttecWidget {
public:
    static constexpr Time kStalled = std::chrono::seconds(1);   // a widget that takes no byte for so long is stuck
    static constexpr Time kAskEvery = std::chrono::seconds(1);  // whether it is still there
    static constexpr Time kSilent = std::chrono::seconds(2);    // and it does not answer

    EnttecWidget(ByteStream& line, Clock& clock) : line_(line), clock_(clock), moved_(clock.now()), asked_(clock.now()) {}

    // Asks for the parameters: what answers is a widget.
    Result<WidgetParameters> meet();
    // The eight digits of its own serial number, "" where it has none.
    Result<std::string> number();
    // Writes parameters where it has others, and looks whether it took them.
    Result<void> arrange(const WidgetParameters& wanted);
    // What it is called; "" where it does not know. Ends what it sends out.
    Result<std::string> name();

    // To be sent by work().
    void say(WidgetLabel label, std::span<const std::uint8_t> data);
    // Whether all that was said has gone.
    bool idle() const { return outgoing_.empty(); }
    // Sends and hears until `until`, and asks now and then whether the widget is still there: by
    // the one question that leaves it sending.
    Result<void> work(Time until, const std::function<void(const WidgetMessage&)>& hear);

private:
    using Data = std::vector<std::uint8_t>;
    Result<std::optional<Data>> answer(WidgetLabel label, std::span<const std::uint8_t> question, Time patience);
    Result<void> push();  // what the line takes
    Result<void> pull(Time patience);

    ByteStream& line_;
    Clock& clock_;
    WidgetParser parser_;
    Data outgoing_;
    Time moved_;  // when the line last took a byte, or had none to take
    Time asked_;
    bool answered_ = true;
};

}  // namespace fantascope::drivers
