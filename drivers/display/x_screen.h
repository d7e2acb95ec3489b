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

// The default X screen and its monitors, by a connection of its own (XCB, the RandR extension 1.3
// or later), whose errors are values: a monitor may vanish between two requests. Its calls wait for
// the X server's answers. While it lives, the screen is never blanked.
// Thread: thread-bound, to any one thread.
class XScreen {
public:
    // Error: there is no X server, or it has no RandR.
    static Result<std::unique_ptr<XScreen>> open();
    // The X server that open() would ask, by its address, ":0"; "" where none is named. Asks
    // nobody.
    static std::string serverName();
    // Gives the screen saver and the power saving their settings back.
    ~XScreen();
    XScreen(const XScreen&) = delete;
    XScreen& operator=(const XScreen&) = delete;

    // Readable when the X server has something to tell.
    int fileDescriptor() const;
    // Takes in what the X server has told meanwhile, without waiting: whether any monitor changed.
    // Error: the X server is gone.
    Result<bool> changed();
    // Every connector, in the X server's order. Error: the X server is gone, or the monitors
    // changed meanwhile (ask again).
    Result<std::vector<Monitor>> monitors();
    glm::ivec2 largest() const { return largest_; }  // pixels that the screen can have; known from monitors()
    // Makes the screen at least that large. Error: it cannot be.
    Result<void> grow(glm::ivec2 size);
    enum class Applied {
        Done,
        Refused,  // by the X server or the graphics driver
        TooLate   // the monitors changed since monitors()
    };
    Applied apply(const Placement::Change& change);
    // Turns off the screen saver and the monitors' power saving, and wakes them up, whoever turned
    // them on meanwhile.
    void keepAwake();

private:
    struct Wakefulness;
    XScreen(xcb_connection_t* connection, std::uint32_t root);
    // Makes the X server look for monitors. It holds up everybody for tens of milliseconds, and
    // does so by itself when cables are plugged.
    void lookAtConnectors();

    xcb_connection_t* connection_;
    std::uint32_t root_;
    std::uint8_t firstRandrEvent_ = 0;
    std::uint32_t edid_ = 0;        // the atom of the property that holds it
    std::uint32_t configured_ = 0;  // the X server's time of the configuration that monitors() listed
    glm::ivec2 size_{0}, largest_{0};
    std::set<std::uint32_t> on_;         // outputs that monitors() found on
    std::set<std::uint32_t> unplugged_;  // outputs that were without a monitor since monitors()
    std::unique_ptr<Wakefulness> before_;
};

}  // namespace fantascope::drivers
