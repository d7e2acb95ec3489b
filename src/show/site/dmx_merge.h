#pragma once

#include "core/clock.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope::show {

using DmxSlots = std::array<std::uint8_t, 512>;  // of one universe; [0] is address 1

// One frame of a universe from a desk. The frame does not own its slots and its sender.
struct DmxFrame {
    std::span<const std::uint8_t, 512> slots;
    std::string_view sender;  // identifies the desk
    int priority = 100;       // 0 .. 200, as in E1.31
    Time arrived{};
    Time silence{};      // the sender's timeout: how long it may be silent before it counts as gone
    bool ended = false;  // a termination packet: the sender has ended its stream, and the slots mean nothing
};

// Merges the senders of one universe: our own levels, and desks that come and go. The highest
// priority gets the whole universe. Senders of equal priority are merged slot by slot, by the rule.
//
// A desk is gone when it sent a termination packet, or when it was silent for longer than its
// timeout. If the desk of the highest priority falls silent, its last levels hold for the settling
// time, and only then does a lower priority take over. So a loose cable does not make the fixtures
// jump to and fro. A termination packet, or a lower priority sent by the desk itself, is intended
// and acts at once.
//
// All times are on one clock and never decrease. In steady state nothing allocates. Thread:
// thread-bound.
class DmxMerge {
public:
    enum class Rule {
        Highest,  // HTP: the highest level wins
        Latest    // LTP: the level that changed last wins. A new sender counts as having been at zero.
    };
    struct Settings {
        Rule rule = Rule::Highest;
        int ownPriority = 100;
        Time settling = std::chrono::seconds(1);
    };
    static constexpr std::size_t kMostSenders = 16;  // desks at once; further ones are ignored

    // A sender whose levels are in the merge.
    struct Charge {
        std::string_view sender;  // "": our own levels
        int priority = 100;
        bool settling = false;  // the sender is silent, and its last levels hold for the settling time
    };

    explicit DmxMerge(const Settings& settings);

    // Takes a frame. Frames come in the order of their arrival.
    void receive(const DmxFrame& frame);
    // From now on our own changes claim no slot (Rule::Latest): a desk keeps the slots that it
    // changed last.
    void claimNothing() { claims_ = false; }
    // Merges the slots of the universe at `now`, which is not before the arrival of any frame so
    // far. `asked`: our own levels before the camera trimmed them, because a trim claims no slot.
    // `own` and `out` may be the same.
    void mergeAt(Time now, std::span<const std::uint8_t, 512> own, std::span<const std::uint8_t, 512> asked,
                 std::span<std::uint8_t, 512> out);
    // The senders in charge at the last merge: our own levels first, then the desks in the order in
    // which they appeared. Valid until the next call of a non-const method.
    std::span<const Charge> inCharge() const { return inCharge_; }

private:
    struct Source {
        std::string sender;
        int priority = 100;
        Time arrived{}, silence{};
        DmxSlots slots{};
        std::array<Time, 512> changed{};  // when each slot last changed
    };
    static void setSlots(Source& source, std::span<const std::uint8_t, 512> slots, Time when);
    bool isLive(const Source& source, Time now) const { return now - source.arrived <= source.silence; }

    Settings settings_;
    bool claims_ = true;
    Source own_;
    DmxSlots asked_{};
    std::vector<Source> sources_;  // the first count_ are in use, in the order in which they appeared
    std::size_t count_ = 0;
    std::vector<const Source*> winners_;
    std::vector<Charge> inCharge_;
};

}  // namespace fantascope::show
