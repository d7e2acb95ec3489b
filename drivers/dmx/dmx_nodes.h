#pragma once

#include "drivers/common/found_device.h"
#include "drivers/dmx/artnet_packet.h"

#include "core/clock.h"

#include <vector>

namespace fantascope::drivers {

// Who answers an ArtPoll on any network of this machine, one entry for each port, and which sACN
// sources announce themselves (they do so every ten seconds). Listens for `patience`. A program
// that is playing on this machine goes on undisturbed: what is sent to its own sockets stays with
// them, so that another program then hears of fewer nodes.
std::vector<FoundDevice> findDmxNodes(Time patience = std::chrono::seconds(3));

// For the Art-Net driver: a node has answered on a socket of this program's own. Thread:
// thread-safe.
void noteNode(Ipv4 from, const artnet::PollReply& reply);

}  // namespace fantascope::drivers
