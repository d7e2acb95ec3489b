#pragma once
// Shared by the tests of DMX over a network.

#include "drivers/registry.h"

#include "contract/dmx_port_suite.h"
#include "core/clock.h"
#include "core/config/config.h"
#include "peers/own_network.h"
#include "peers/plain_dmx.h"

#include <fmt/format.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace fantascope::peers {

// Open a port or a source on this program's own clock, and wait until it is Running if requested.
inline SteadyClock& testClock() {
    static SteadyClock clock;
    return clock;
}
inline const drivers::DriverContext& night() {
    static const drivers::DriverContext context{testClock()};
    return context;
}
inline ConfigNode options(const std::string& text) { return ConfigNode::parse(text, "site.yaml").value(); }
inline std::unique_ptr<DmxPort> openPort(const std::string& keys, int universe) {
    return drivers::openDmxPort(options(keys), universe, night()).value();
}
inline std::unique_ptr<DmxSource> openSource(const std::string& keys, int universe) {
    return drivers::openDmxSource(options(keys), universe, night()).value();
}
inline bool runs(const Device& device) { return device.status().state == DeviceState::Running; }

// A far end that reads levels by its own hand-written offsets and, as a node, answers polls.
class Ear {
public:
    explicit Ear(const std::string& protocol, bool answers = true) : isSacn_(protocol == "sacn"), answers_(answers) {
        socket_ = madeThere([&] { return PlainSocket("far", "", isSacn_ ? 5568 : 6454); });
    }
    void join(int universe) {
        there([&] { socket_.join("far", sacnGroup(universe)); });
    }
    void answer(bool yes) { answers_ = yes; }

    // Reads everything that has arrived, or if nothing has, what arrives within `timeout`
    // milliseconds. Returns whether anything arrived.
    bool listen(int timeout = 2) {
        bool any = false;
        std::string from;
        for (Datagram bytes = socket_.receive(timeout, &from); !bytes.empty(); bytes = socket_.receive(0, &from)) {
            any = true;
            const auto levels = isSacn_ ? readPlainSacn(bytes) : readPlainArtDmx(bytes);
            if (levels) heard[levels->universe].push_back(*levels);
            if (!isSacn_ && answers_ && isArtPoll(bytes)) socket_.send(plainArtPollReply(), from, 6454);
            packets.push_back(std::move(bytes));
        }
        return any;
    }
    // Listens until a condition holds; false after half a minute.
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

    std::map<int, std::vector<PlainLevels>> heard;  // per universe, oldest first
    std::vector<Datagram> packets;                  // of all kinds

private:
    bool isSacn_, answers_;
    PlainSocket socket_;
};

}  // namespace fantascope::peers
