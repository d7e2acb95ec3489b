#pragma once
// Faults, one after another, on a bank of relays in use: what the peer saw of it.

#include "core/clock.h"
#include "peers/modbus_peer.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace fantascope {

struct ModbusCampaign {
    static constexpr Time kSoon = std::chrono::seconds(2);  // within which a fault that is over is to be mended

    std::map<std::string, std::vector<double>> recovery;  // s from the end of a fault to the wanted states, by the kind of fault
    std::vector<std::string> slow;                        // what was not mended soon, step by step
    std::vector<std::string> wrong;                       // what may never happen, in words
    std::size_t writes = 0;                               // that the modules saw
    std::size_t stalls = 0;                               // of a module's process, which began a fault anew that was over
};

// As the program does it (src/app/live/lighting.cpp): the wanted states are written when they
// change, after every loss, and again where a write failed. A module's process that gets no
// processor for half a response time-out hangs like one that was stopped: such a fault is not over
// before the process goes on.
ModbusCampaign runModbusCampaign(ModbusPeer::Wire wire, int faults, std::uint64_t seed);

}  // namespace fantascope
