#pragma once

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

#include "core/clock.h"
#include "core/image.h"
#include "device/camera_source.h"
#include "device/cue_controller.h"
#include "device/dmx_source.h"

namespace fantascope::site {

// The far end of every simulated device: what lamps, relays, projectors, the hand and the camera of the simulated site are doing now.
// The simulated drivers act on it from one side; the scene (simulated_site.h), tests and the rehearsal's operator from the other.
// Thread: thread-safe; no call waits for more than a copy.
class World {
public:
    explicit World(const Clock& clock) : clock_(clock) {}

    const Clock& clock() const { return clock_; }

    // Pulls a device's plug, or puts it back. Devices go by their name in the site file: an output's name, "universe N", "relay bank",
    // "cue controller", "camera", "contacts", "desk N".
    void setPlugged(const std::string& device, bool plugged);
    bool plugged(const std::string& device) const;

    // Lamps: what each universe's line carried last. All zero before the first frame.
    void setSlots(int universe, std::span<const std::uint8_t, kDmxSlots> slots);
    std::array<std::uint8_t, kDmxSlots> slots(int universe) const;

    // Relays of the one simulated bank.
    void setRelays(const std::vector<bool>& states);
    std::vector<bool> relays() const;

    // Contacts of the simulated input bank.
    void setContact(std::size_t contact, bool closed);
    bool contact(std::size_t contact) const;

    // Somebody else's desk on a universe.
    void sendFromDesk(int universe, const DmxInput& frame);
    std::optional<DmxInput> takeFromDesk(int universe);

    // The hand on the cue controller: events wait until the driver takes them; lost while it is unplugged. `at` is set to the clock's now.
    void press(int button, bool pressed);
    std::optional<ButtonEvent> takePress();

    // Projectors: the frame each one throws on the wall now; null before the first.
    void setFrame(const std::string& output, std::shared_ptr<const RgbaImage> frame);
    std::shared_ptr<const RgbaImage> frame(const std::string& output) const;

    // The camera: frames become visible to the driver at `due`.
    void sendFromCamera(std::shared_ptr<const CameraFrame> frame, Time due);
    std::shared_ptr<const CameraFrame> takeFromCamera();  // the newest that is due and was not taken; older ones are dropped

private:
    const Clock& clock_;
    mutable std::mutex mutex_;
    std::set<std::string> unplugged_;
    std::map<int, std::array<std::uint8_t, kDmxSlots>> slots_;
    std::vector<bool> relays_;
    std::map<std::size_t, bool> contacts_;
    std::map<int, std::deque<DmxInput>> desk_;
    std::deque<ButtonEvent> presses_;
    std::map<std::string, std::shared_ptr<const RgbaImage>> frames_;
    std::deque<std::pair<Time, std::shared_ptr<const CameraFrame>>> camera_;
};

}  // namespace fantascope::site
