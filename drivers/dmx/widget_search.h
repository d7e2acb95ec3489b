#pragma once

#include "drivers/byte_stream/serial.h"
#include "drivers/common/found_device.h"
#include "drivers/common/surroundings.h"

#include "core/config.h"

#include <string>
#include <vector>

namespace fantascope::drivers {

// Which widget a site file means.
struct WidgetChoice {
    SerialIdentity line;  // the keys `port` and `serial`
    std::string number;   // the widget's own, where the driver can ask for it: the key `number`
};
void readWidgetLine(ConfigFields& fields, SerialIdentity& line);
void readWidgetNumber(ConfigFields& fields, std::string& number);
// The line or widget that a choice takes for itself.
Use useOf(const WidgetChoice& choice);
// What a program claims of it (Opening::claim): the line that the search would take now, else what
// is searched for. By its number alone a widget is found by asking it, which a claim does not: only
// the line's own lock holds that one.
std::string claimOf(const WidgetChoice& choice);

// Where to look for it. Without port and serial that is the one adapter that calls itself a DMX
// widget; with a number alone each adapter by FTDI in turn.
SerialStream::Find widgetFinder(const WidgetChoice& choice);

// How a widget of Enttec's Pro kind is spoken to. The rate counts for nothing: its adapter hands
// the bytes over at once.
constexpr SerialSettings kWidgetSettings{.rate = 57600, .stopBits = 2};

// The adapters on this machine that are or may be DMX widgets. Those that call themselves so and
// are not in use are asked what they are, which ends what they send out. Takes up to 2 s for each
// that does not answer. Thread: any.
std::vector<FoundDevice> findWidgets();

}  // namespace fantascope::drivers
