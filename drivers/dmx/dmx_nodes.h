#pragma once

#include "drivers/common/found_device.h"
#include "drivers/dmx/artnet_packet.h"

#include "core/clock.h"

#include <vector>

namespace fantascope::drivers {

// All nodes that answer an ArtPoll on any network of this machine, one entry per port, and all sACN
// sources that announce themselves (every ten seconds). Listens for `timeout`. A show that plays on
// this machine is not disturbed: its sockets keep their packets, so another program then sees fewer
// nodes.
std::vector<FoundDevice> findDmxNodes(Time timeout = std::chrono::seconds(3));

// For the Art-Net driver, which reports nodes that answered on a socket of this program. Thread:
// thread-safe.
void noteNode(Ipv4 from, const artnet::PollReply& reply);

}  // namespace fantascope::drivers
