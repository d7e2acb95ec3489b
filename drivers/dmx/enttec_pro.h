#pragma once

#include "drivers/common/opening.h"
#include "drivers/common/service.h"
#include "drivers/dmx/enttec_widget.h"
#include "drivers/dmx/widget_search.h"

#include "device/dmx_port.h"
#include "device/dmx_source.h"

#include "core/config/config.h"

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace fantascope::drivers {

// An Enttec DMX USB Pro or a compatible widget. Thread: bound to the thread of its device.
class EnttecPro {
public:
    struct Options {
        WidgetChoice which;
        std::optional<int> breakTime, markAfterBreak;  // in WidgetParameters' units; nothing: the widget's setting
        std::optional<int> rate;                       // frames a second; nothing: the widget's setting
    };
    // The work with a widget that was found and configured, until the service ends or something
    // fails.
    using Work = std::function<Result<void>(EnttecWidget&, const WidgetParameters&, const std::string& number)>;

    EnttecPro(const std::string& name, Options options, Clock& clock);
    Outage runOnce(Service& service, const Work& work);

private:
    struct Handshake {
        WidgetParameters parameters;
        std::string number;
    };
    Result<Handshake> handshake(EnttecWidget& widget);

    const Options options_;
    Clock& clock_;
    SerialStream line_;
};

// A universe sent by a DMX USB Pro.
class EnttecProPort final : public DmxPort {
public:
    static Result<Opening<DmxPort>> fromConfig(const ConfigNode& options, int universe);

    DeviceStatus status() const override { return service_.status(); }
    Result<void> send(std::span<const std::uint8_t, kDmxSlots> slots) override;

private:
    EnttecProPort(const std::string& name, EnttecPro::Options options, Clock& clock);
    Result<void> repeat(Service& service, EnttecWidget& widget, double rate);

    Clock& clock_;
    std::mutex mutex_;
    std::optional<DmxPacket> newest_;
    EnttecPro widget_;
    Service service_;
};

// A universe received by a DMX USB Pro. The sender is the widget's own serial number.
class EnttecProSource final : public DmxSource {
public:
    static Result<Opening<DmxSource>> fromConfig(const ConfigNode& options, int universe);

    DeviceStatus status() const override { return service_.status(); }
    std::optional<DmxInput> receive() override;

private:
    EnttecProSource(const std::string& name, EnttecPro::Options options, Clock& clock);
    Result<void> listen(Service& service, EnttecWidget& widget, const std::string& number);

    Clock& clock_;
    std::mutex mutex_;
    std::deque<DmxInput> arrived_;
    EnttecPro widget_;
    Service service_;
};

}  // namespace fantascope::drivers
