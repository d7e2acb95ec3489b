#pragma once

#include "drivers/display/monitor.h"
#include "drivers/display/placement.h"

#include "core/result.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <vector>

struct xcb_connection_t;

namespace fantascope::drivers {

// The default X screen and its monitors, through a connection of its own (XCB, with the RandR
// extension 1.3 or later). Errors are values, because a monitor may vanish between two requests.
// Its calls wait for the X server's replies. While it exists, the screen never blanks.
// Thread: thread-bound, to any one thread.
class XScreen {
public:
    // Error: there is no X server, or it has no RandR.
    static Result<std::unique_ptr<XScreen>> open();
    // The address of the X server that open() would use, ":0"; "" if none is named. Connects to
    // none.
    static std::string serverName();
    // Restores the settings of the screen saver and of power saving.
    ~XScreen();
    XScreen(const XScreen&) = delete;
    XScreen& operator=(const XScreen&) = delete;

    // Readable when the X server has sent something.
    int fileDescriptor() const;
    // Handles what the X server has sent, without waiting. Returns whether any monitor changed.
    // Error: the X server is gone.
    Result<bool> changed();
    // All connectors, in the X server's order. Error: the X server is gone, or the monitors changed
    // meanwhile (call again).
    Result<std::vector<Monitor>> monitors();
    glm::ivec2 largest() const { return largest_; }  // maximum size of the screen in pixels; known after monitors()
    // Makes the screen at least that large. Error: impossible.
    Result<void> grow(glm::ivec2 size);
    enum class Applied {
        Done,
        Refused,  // by the X server or the graphics driver
        TooLate   // the monitors changed since monitors()
    };
    Applied apply(const Placement::Change& change);
    // Turns off the screen saver and power saving, and wakes the monitors, even if another program
    // turned them on meanwhile.
    void keepAwake();

private:
    struct Wakefulness;
    XScreen(xcb_connection_t* connection, std::uint32_t root);
    // Makes the X server probe its connectors. It blocks all clients for tens of milliseconds. The
    // X server does this by itself when cables are plugged.
    void probeConnectors();

    // Remembers which outputs are on. Returns whether the X server's knowledge of a connector is
    // old, so that probeConnectors() is needed.
    bool noteOn(const std::vector<Monitor>& monitors);

    xcb_connection_t* connection_;
    std::uint32_t root_;
    std::uint8_t firstRandrEvent_ = 0;
    std::uint32_t edid_ = 0;        // the atom of its property
    std::uint32_t configured_ = 0;  // the X server's time stamp of the configuration from monitors()
    glm::ivec2 size_{0}, largest_{0};
    std::set<std::uint32_t> on_;         // outputs that were on in monitors()
    std::set<std::uint32_t> unplugged_;  // outputs without a monitor since monitors()
    std::unique_ptr<Wakefulness> before_;
};

}  // namespace fantascope::drivers
