#pragma once
// What the tests of DMX over a network have in common.

#include "drivers/registry.h"

#include "contract/dmx_port_suite.h"
#include "core/clock.h"
#include "core/config.h"
#include "peers/own_network.h"
#include "peers/plain_dmx.h"

#include <fmt/format.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace fantascope::peers {

// Opens a port or a source on this program's own clock, and waits until it runs where that is
// wanted.
inline SteadyClock& testClock() {
    static SteadyClock clock;
    return clock;
}
inline const drivers::Surroundings& night() {
    static const drivers::Surroundings around{testClock()};
    return around;
}
inline ConfigNode options(const std::string& text) { return ConfigNode::parse(text, "site.yaml").value(); }
inline std::unique_ptr<DmxPort> openPort(const std::string& keys, int universe) {
    return drivers::openDmxPort(options(keys), universe, night()).value();
}
inline std::unique_ptr<DmxSource> openSource(const std::string& keys, int universe) {
    return drivers::openDmxSource(options(keys), universe, night()).value();
}
inline bool runs(const Device& device) { return device.status().state == DeviceState::Running; }

// A far end that hears levels by its own hand-written offsets and, as a node, answers polls.
class Ear {
public:
    explicit Ear(const std::string& protocol, bool answers = true) : isSacn_(protocol == "sacn"), answers_(answers) {
        socket_ = madeThere([&] { return PlainSocket("far", "", isSacn_ ? 5568 : 6454); });
    }
    void join(int universe) {
        there([&] { socket_.join("far", sacnGroup(universe)); });
    }
    void answer(bool yes) { answers_ = yes; }

    // All that has arrived so far, and what arrives within `patience` milliseconds if that is
    // nothing. Whether anything came.
    bool listen(int patience = 2) {
        bool any = false;
        std::string from;
        for (Datagram bytes = socket_.receive(patience, &from); !bytes.empty(); bytes = socket_.receive(0, &from)) {
            any = true;
            const auto levels = isSacn_ ? readPlainSacn(bytes) : readPlainArtDmx(bytes);
            if (levels) heard[levels->universe].push_back(*levels);
            if (!isSacn_ && answers_ && isArtPoll(bytes)) socket_.send(plainArtPollReply(), from, 6454);
            packets.push_back(std::move(bytes));
        }
        return any;
    }
    // Listens until a condition holds: false after half a minute without.
    bool listenUntil(const std::function<bool()>& condition) {
        return eventually([&] {
            listen();
            return condition();
        });
    }
    void forget() {
        listen(0);
        heard.clear();
        packets.clear();
    }

    std::map<int, std::vector<PlainLevels>> heard;  // of each universe, oldest first
    std::vector<Datagram> packets;                  // whatever they are

private:
    bool isSacn_, answers_;
    PlainSocket socket_;
};

}  // namespace fantascope::peers
