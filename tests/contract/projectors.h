#pragma once
// An X server with several outputs, and what a stagehand does to its projectors and cables.

#include "contract/x_server.h"
#include "core/result.h"
#include "scratch_folder.h"

#include <glm/vec2.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

struct xcb_connection_t;

namespace fantascope {

// Xorg with its dummy driver, which really sets modes, but on no card. Its connectors are DUMMY0 to
// DUMMY15; DUMMY0 is on at the start. Once a connector was on, it has a projector for ever; an
// unplugged one is recognised by its EDID.
class Projectors {
public:
    static constexpr glm::ivec2 kSize{320, 180};
    static constexpr double kHertz[] = {60, 59.94, 75};  // the modes of that size
    static constexpr glm::ivec2 kLarge{640, 360};        // and one of this, at 60 Hz

    // Error: Xorg does not start, why, and the packages that it needs.
    static Result<std::unique_ptr<Projectors>> start();
    ~Projectors();

    XServer& server() { return *server_; }
    // The X server crashes, and another one starts on the same display in its initial state.
    void crash();
    void startAgain();
    // Puts a projector with this EDID on a connector that was on before; without bytes, one that
    // reports nothing.
    void plug(const std::string& connector, std::span<const std::uint8_t> edid);
    enum class Looks { Before, AndAfter };  // when it makes the X server probe its connectors, like the command `xrandr`
    void switchOn(const std::string& connector, glm::ivec2 corner, glm::ivec2 size = kSize, double hertz = 60,
                  Looks looks = Looks::AndAfter);
    void switchOff(const std::string& connector);
    // The shown part of the screen, and the rate. Nothing: it is off.
    struct Picture {
        glm::ivec2 corner, size;
        double hertz;
        bool operator==(const Picture&) const = default;
    };
    std::optional<Picture> picture(const std::string& connector) const;

    // After how many seconds without a key the screen blanks; 0: never.
    int blanksAfter() const;
    // Whether a pointer is visible there.
    bool pointerSeenAt(glm::ivec2 pixel) const;

private:
    Projectors() = default;
    void connect();
    std::uint32_t output(const std::string& connector) const;

    const BrokenPipesIgnored ignored_;
    ScratchFolder folder_;
    std::unique_ptr<XServer> server_;
    xcb_connection_t* connection_ = nullptr;
    std::uint32_t root_ = 0;
};

}  // namespace fantascope
