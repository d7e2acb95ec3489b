#pragma once

#include "device/camera_source.h"
#include "device/cue_controller.h"
#include "device/dmx_source.h"

#include "core/clock.h"
#include "media/image.h"

#include <array>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace fantascope::site {

// The far end of every simulated device: the current state of the simulated site's lamps, relays,
// projectors, cue controller and camera. The simulated drivers act on it from one side; the scene
// (simulated_site.h), tests and the rehearsal's operator from the other. Nothing passes an
// unplugged device in either direction, and whatever was on its way is lost. Thread: thread-safe;
// no call waits longer than for a copy.
class World {
public:
    explicit World(const Clock& clock) : clock_(clock) {}

    const Clock& clock() const { return clock_; }

    // Unplugs a device, or plugs it in. Devices have their names from the site file: an output's or
    // a bank's name, "universe N", "desk N", "cue controller", "camera". All are plugged in at
    // first.
    void setPlugged(const std::string& device, bool plugged);
    bool plugged(const std::string& device) const;
    // How often the device was lost so far, by its plug or by hand at its relays. It shows a driver
    // a loss that was over before the driver looked.
    int losses(const std::string& device) const;

    // Whether OpenGL works for an output, plugged in or not. It does at first.
    void setGraphics(const std::string& output, bool work);
    bool graphicsWork(const std::string& output) const;

    // Lamps: the last frame of each universe; all zero before the first. Lamps hold it while the
    // line is silent.
    // False: the line is unplugged; the lamps see nothing.
    bool setSlots(int universe, std::span<const std::uint8_t, kDmxSlots> slots);
    std::array<std::uint8_t, kDmxSlots> slots(int universe) const;

    // Relays of a bank. installRelays() adds the bank: its relays take their safe states now, and
    // whenever it is unplugged. states.size() is the installed number.
    void installRelays(const std::string& bank, const std::vector<bool>& safeStates);
    bool setRelays(const std::string& bank, const std::vector<bool>& states);  // false: unplugged, nothing changes
    // A person at the module switches them. If they were as written, that is a loss.
    void switchRelaysByHand(const std::string& bank, const std::vector<bool>& states);
    std::vector<bool> relays(const std::string& bank) const;  // empty before installRelays()

    // Contacts of an input bank; all open at first. They move whether or not anybody is connected.
    void setContact(const std::string& bank, std::size_t contact, bool closed);
    bool contact(const std::string& bank, std::size_t contact) const;

    // Another desk on a universe: frames wait until the driver takes them, oldest first. `arrived`
    // is set to the clock's now. Beyond kDeskDepth older frames are dropped, but never the newest
    // of a sender.
    static constexpr std::size_t kDeskDepth = 16;
    void sendFromDesk(int universe, DmxInput frame);
    std::optional<DmxInput> takeFromDesk(int universe);

    // The operator's hand on the cue controller: events wait until the driver takes them. `at` is
    // set to the clock's now.
    void press(int button, bool pressed);
    std::optional<ButtonEvent> takePress();
    // The lights of its buttons, from 1 on: as set, and as shown, which is off while unplugged.
    void setLight(int button, const ButtonLight& light);
    ButtonLight light(int button) const;

    // Projectors: the frame that each shows now; null before the first, and from unplugging to the
    // next frame.
    void setFrame(const std::string& output, std::shared_ptr<const RgbaImage> frame);
    std::shared_ptr<const RgbaImage> frame(const std::string& output) const;

    // The camera: frames become visible to the driver at `due`, which only rises.
    void sendFromCamera(std::shared_ptr<const CameraFrame> frame, Time due);
    std::shared_ptr<const CameraFrame> takeFromCamera();  // the newest that is due and was not taken; older ones are dropped

private:
    struct Plug {
        bool in = true;
        int losses = 0;
    };
    struct Relays {
        std::vector<bool> states, safe;
        bool asWritten = false;  // false after a loss
    };
    bool isIn(const std::string& device) const;  // with mutex_ held

    const Clock& clock_;
    mutable std::mutex mutex_;
    std::map<std::string, Plug> plugs_;
    std::set<std::string> withoutGraphics_;
    std::map<int, std::array<std::uint8_t, kDmxSlots>> slots_;
    std::map<std::string, Relays> relays_;
    std::set<std::pair<std::string, std::size_t>> closed_;
    std::map<int, std::deque<DmxInput>> desk_;
    std::deque<ButtonEvent> presses_;
    std::map<int, ButtonLight> lights_;
    std::map<std::string, std::shared_ptr<const RgbaImage>> frames_;
    std::deque<std::pair<Time, std::shared_ptr<const CameraFrame>>> camera_;
};

}  // namespace fantascope::site
