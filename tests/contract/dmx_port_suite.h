#pragma once

#include "device/dmx_port.h"

#include "contract/rig.h"

#include <array>
#include <optional>

namespace fantascope::contract {

using DmxFrame = std::array<std::uint8_t, kDmxSlots>;

class DmxPortRig : public Rig<DmxPort> {
public:
    // What the line repeats now; nothing while it is silent.
    virtual std::optional<DmxFrame> line() = 0;
    // The last frame that reached the lamps, even from before reopen().
    virtual std::optional<DmxFrame> lastFrame() = 0;
};

// A frame whose slots differ from their neighbours; any two frames differ in every slot.
inline DmxFrame dmxFrame(int number) {
    DmxFrame frame;
    for (std::size_t slot = 0; slot < frame.size(); ++slot)
        frame[slot] = static_cast<std::uint8_t>(number + 7 * static_cast<int>(slot));
    return frame;
}

inline std::string lineDiffers(DmxPortRig& rig, const DmxFrame& wanted) {
    rig.letTimePass();
    const auto line = rig.line();
    CONTRACT_REQUIRE(line.has_value(), "the line is silent");
    for (std::size_t slot = 0; slot < kDmxSlots; ++slot)
        CONTRACT_REQUIRE((*line)[slot] == wanted[slot], "slot {} carries {}, not {}", slot, (*line)[slot], wanted[slot]);
    return "";
}

// Every promise of device/dmx_port.h.
inline Suite<DmxPortRig> dmxPortSuite() {
    const auto serves = [](DmxPortRig& rig) -> std::string {
        for (const int number : {3, 4}) {
            CONTRACT_SUCCEEDS(rig.port().send(dmxFrame(number)));
            if (auto wrong = lineDiffers(rig, dmxFrame(number)); !wrong.empty()) return wrong;
        }
        return "";
    };
    return joined<DmxPortRig>(lifeClauses<DmxPortRig>(serves),
                              {
                                  {"the line carries all 512 slots of the frame that was sent", serves},
                                  {"a newer frame replaces an unsent one",
                                   [](DmxPortRig& rig) -> std::string {
                                       for (const int number : {1, 2, 3}) CONTRACT_SUCCEEDS(rig.port().send(dmxFrame(number)));
                                       return lineDiffers(rig, dmxFrame(3));
                                   }},
                                  {"the line repeats the newest frame by itself",
                                   [](DmxPortRig& rig) -> std::string {
                                       CONTRACT_SUCCEEDS(rig.port().send(dmxFrame(1)));
                                       for (int time = 0; time < 5; ++time)
                                           if (auto wrong = lineDiffers(rig, dmxFrame(1)); !wrong.empty()) return wrong;
                                       return "";
                                   }},
                                  {"the newest frame goes out before the port closes",
                                   [](DmxPortRig& rig) -> std::string {
                                       CONTRACT_SUCCEEDS(rig.port().send(dmxFrame(1)));
                                       rig.letTimePass();
                                       CONTRACT_SUCCEEDS(rig.port().send(dmxFrame(2)));
                                       rig.reopen();
                                       CONTRACT_REQUIRE(rig.lastFrame() == dmxFrame(2), "the lamps keep an older one");
                                       return "";
                                   }},
                                  {"a lost line is silent",
                                   [](DmxPortRig& rig) -> std::string {
                                       CONTRACT_SUCCEEDS(rig.port().send(dmxFrame(1)));
                                       rig.lose();
                                       CONTRACT_REQUIRE(!rig.line(), "it still speaks");
                                       return "";
                                   }},
                                  {"sending on a lost line is an error that says why",
                                   [](DmxPortRig& rig) -> std::string {
                                       rig.lose();
                                       const auto sent = rig.port().send(dmxFrame(1));
                                       CONTRACT_REQUIRE(!sent, "it claims to have sent the frame");
                                       CONTRACT_REQUIRE(!sent.error().message().empty(), "the error is empty");
                                       return "";
                                   }},
                                  {"a frame that was sent while lost never comes out",
                                   [](DmxPortRig& rig) -> std::string {
                                       rig.lose();
                                       (void)rig.port().send(dmxFrame(1));
                                       rig.giveBack();
                                       (void)rig.port().status();
                                       rig.letTimePass();
                                       CONTRACT_REQUIRE(rig.line() != dmxFrame(1), "it came out after the return");
                                       return "";
                                   }},
                              });
}

}  // namespace fantascope::contract
