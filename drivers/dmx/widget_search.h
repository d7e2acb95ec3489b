#pragma once

#include "drivers/byte_stream/serial.h"
#include "drivers/common/found_device.h"
#include "drivers/common/opening.h"

#include "core/config/config.h"

#include <string>
#include <vector>

namespace fantascope::drivers {

// The widget that a site file names.
struct WidgetChoice {
    SerialIdentity line;  // the keys `port` and `serial`
    std::string number;   // the widget's own serial number, if the driver can ask for it: the key `number`
};
void readWidgetLine(ConfigFields& fields, SerialIdentity& line);
void readWidgetNumber(ConfigFields& fields, std::string& number);
// The line or widget that a choice uses exclusively.
Use useOf(const WidgetChoice& choice);
// The name for Opening::claim: the line that the search would take now, else the description.
// Finding a widget by `number` alone means asking it, which a claim must not do; such a widget is
// protected only by the lock of its line.
std::string claimOf(const WidgetChoice& choice);

// Finds its line. Without port and serial: the only adapter that calls itself a DMX widget. With a
// number alone: each FTDI adapter in turn.
SerialStream::Find widgetFinder(const WidgetChoice& choice);

// The serial settings for Enttec Pro widgets. The rate does not matter: the adapter forwards bytes
// at once.
constexpr SerialSettings kWidgetSettings{.rate = 57600, .stopBits = 2};

// The adapters on this machine that are or may be DMX widgets. Those that call themselves widgets
// and are not in use are asked for their details, which ends their output. Takes up to 2 s per
// widget that does not answer. Thread: any.
std::vector<FoundDevice> findWidgets();

}  // namespace fantascope::drivers
