#pragma once

#include "drivers/common/found_device.h"
#include "drivers/common/opening.h"
#include "drivers/common/service.h"
#include "drivers/common/usb_identity.h"
#include "drivers/cue_controller/button_events.h"
#include "drivers/cue_controller/button_lights.h"

#include "device/cue_controller.h"

#include "core/config/config.h"

#include <atomic>
#include <memory>
#include <string>
#include <vector>

namespace fantascope::drivers {

struct HidProfile;
class UsbBus;

// Any USB HID controller: presenters, pedals, jog wheels, key pads, gamepads. All its HID
// interfaces are claimed, so its keys reach no other program.
class UsbHidController final : public CueController {
public:
    // From the site file; README.md lists the keys.
    struct Options {
        std::string vendor, product, serial, path;  // empty: any
        const HidProfile* profile = nullptr;        // null: by vendor and product, if there is one
        Time debounce = std::chrono::milliseconds(5);
        bool asksState = true;
        double brightness = 0.5;  // of its lamps, 0..1

        bool fits(const UsbIdentity& usb) const;
        std::string description() const;  // " 046d:c52d with serial 1"; "": any known controller
        std::string notFound() const;     // "no USB controller 046d:c52d with serial 1"
        std::string claim() const;        // for Opening::claim: the device that it would try first
    };

    static Result<Opening<CueController>> fromConfig(const ConfigNode& options);
    ~UsbHidController() override;

    DeviceStatus status() const override { return service_.status(); }
    std::optional<ButtonEvent> poll() override { return events_.poll(); }
    void light(int button, const ButtonLight& light) override;

private:
    UsbHidController(Options options, Clock& clock);
    Outage runOnce(Service& service);

    const Options options_;
    Clock& clock_;
    ButtonEvents events_;
    ButtonLights lights_;
    std::atomic<bool> closing_ = false;
    std::unique_ptr<UsbBus> usb_;
    Service service_;
};

// All HID devices of this machine. Opens none of them.
std::vector<FoundDevice> findControllers();

}  // namespace fantascope::drivers
