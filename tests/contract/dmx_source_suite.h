#pragma once

#include "device/dmx_source.h"

#include "contract/rig.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace fantascope::contract {

class DmxSourceRig : public Rig<DmxSource> {
public:
    // A desk sends a frame whose slots are all `level`; `priority` counts only if the protocol has
    // it.
    virtual void deskSends(const std::string& source, int level, int priority = 100) = 0;
    // The desk terminates its stream. False: the protocol has no termination.
    virtual bool deskTerminates(const std::string& source) = 0;
    // Whether the protocol has priorities.
    virtual bool hasPriority() const { return true; }
    // Whether the protocol tells senders apart. If not, they are all desk "a".
    virtual bool hasSenders() const { return true; }
    // The desk that a frame's source stands for.
    virtual std::string deskOf(const std::string& source) { return source; }
};

// The source's frames once everything has arrived, as "sender:level" or "sender:gone".
inline std::vector<std::string> received(DmxSourceRig& rig) {
    rig.letTimePass();
    std::vector<std::string> frames;
    for (const DmxInput& frame : drained([&] { return rig.port().receive(); }))
        frames.push_back(rig.deskOf(frame.source) + (frame.ended ? ":gone" : fmt::format(":{}", frame.slots[0])));
    return frames;
}

inline std::string receivedDiffers(DmxSourceRig& rig, const std::vector<std::string>& wanted) {
    const auto got = received(rig);
    CONTRACT_REQUIRE(got == wanted, "received [{}], not [{}]", fmt::join(got, " "), fmt::join(wanted, " "));
    return "";
}

// Every promise of device/dmx_source.h.
inline Suite<DmxSourceRig> dmxSourceSuite() {
    const auto serves = [](DmxSourceRig& rig) -> std::string {
        rig.deskSends("a", 1);
        return receivedDiffers(rig, {"a:1"});
    };
    return joined<DmxSourceRig>(
        lifeClauses<DmxSourceRig>(serves),
        {
            {"a frame arrives whole, with its sender, its priority and the time of its arrival",
             [](DmxSourceRig& rig) -> std::string {
                 rig.letTimePass();
                 const Time before = rig.clock().now();
                 rig.deskSends("a", 200, 150);
                 rig.letTimePass();
                 const auto frame = rig.port().receive();
                 CONTRACT_REQUIRE(frame.has_value(), "nothing arrived");
                 for (std::size_t slot = 0; slot < kDmxSlots; ++slot)
                     CONTRACT_REQUIRE(frame->slots[slot] == 200, "slot {} holds {}", slot, frame->slots[slot]);
                 CONTRACT_REQUIRE(rig.deskOf(frame->source) == "a", "sender '{}'", frame->source);
                 CONTRACT_REQUIRE(frame->priority == (rig.hasPriority() ? 150 : 100), "priority {}", frame->priority);
                 CONTRACT_REQUIRE(before <= frame->arrived && frame->arrived <= rig.clock().now(),
                                  "arrived at {} s, sent at {} s", seconds(frame->arrived), seconds(before));
                 return "";
             }},
            {"frames are given once, oldest first, whoever sent them",
             [](DmxSourceRig& rig) -> std::string {
                 for (const int level : {1, 2}) {
                     rig.deskSends("a", level);
                     rig.deskSends("b", level);
                 }
                 const std::string b = rig.hasSenders() ? "b" : "a";
                 if (auto wrong = receivedDiffers(rig, {"a:1", b + ":1", "a:2", b + ":2"}); !wrong.empty()) return wrong;
                 return receivedDiffers(rig, {});
             }},
            {"of each sender at least the newest frame is kept, and in order",
             [](DmxSourceRig& rig) -> std::string {
                 constexpr int kMany = 200;
                 if (rig.hasSenders()) rig.deskSends("quiet", 7);
                 for (int level = 1; level <= kMany; ++level) rig.deskSends("loud", level);
                 rig.letTimePass();
                 int quiet = 0, loud = 0;
                 for (const DmxInput& frame : drained([&] { return rig.port().receive(); })) {
                     int& newest = rig.deskOf(frame.source) == "quiet" ? quiet : loud;
                     CONTRACT_REQUIRE(frame.slots[0] > newest, "{}:{} came after {}", frame.source, frame.slots[0], newest);
                     newest = frame.slots[0];
                 }
                 CONTRACT_REQUIRE(quiet == (rig.hasSenders() ? 7 : 0) && loud == kMany, "the newest were quiet:{} and loud:{}",
                                  quiet, loud);
                 return "";
             }},
            {"a frame says how long its sender may be silent",
             [](DmxSourceRig& rig) -> std::string {
                 rig.deskSends("a", 1);
                 rig.letTimePass();
                 const auto frame = rig.port().receive();
                 CONTRACT_REQUIRE(frame.has_value(), "nothing arrived");
                 CONTRACT_REQUIRE(frame->silence > Time::zero(), "{} s", seconds(frame->silence));
                 return "";
             }},
            {"a termination is given once, after the frames before it, and its sender may come back",
             [](DmxSourceRig& rig) -> std::string {
                 rig.deskSends("a", 1);
                 if (!rig.deskTerminates("a")) return "";
                 if (auto wrong = receivedDiffers(rig, {"a:1", "a:gone"}); !wrong.empty()) return wrong;
                 rig.deskSends("a", 2);
                 return receivedDiffers(rig, {"a:2"});
             }},
            {"a termination is kept when nobody takes frames, as a sender's newest is",
             [](DmxSourceRig& rig) -> std::string {
                 rig.deskSends("a", 1);
                 if (!rig.deskTerminates("a")) return "";
                 for (int level = 1; level <= 100; ++level) rig.deskSends("loud", level);
                 const auto got = received(rig);
                 CONTRACT_REQUIRE(std::find(got.begin(), got.end(), "a:gone") != got.end(), "received [{}]", fmt::join(got, " "));
                 return "";
             }},
            {"a lost source gives nothing, and nothing old after its return",
             [serves](DmxSourceRig& rig) -> std::string {
                 if (auto wrong = serves(rig); !wrong.empty()) return wrong;
                 rig.deskSends("a", 2);
                 rig.lose();
                 rig.deskSends("a", 3);
                 if (auto wrong = receivedDiffers(rig, {}); !wrong.empty()) return wrong;
                 rig.giveBack();
                 return receivedDiffers(rig, {});
             }},
        });
}

}  // namespace fantascope::contract
