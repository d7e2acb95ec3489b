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

// One frame of a universe from somebody else's desk. It lends what it points to.
struct DmxFrame {
    std::span<const std::uint8_t, 512> slots;
    std::string_view sender;  // by which its frames are told from others'
    int priority = 100;       // 0 .. 200, as in E1.31
    Time arrived{};
    Time silence{};      // how long the sender may be silent before it counts as gone
    bool ended = false;  // it said goodbye; its slots mean nothing
};

// What one universe carries when several send it: our own levels and desks that come and go. The
// highest priority wins whole; among equals each slot is merged by the rule.
//
// A desk is gone when it said goodbye, or when it was silent for longer than it may be. If it went
// in silence and was the highest, its last levels hold for the settling time before a lower
// priority is let through, so that a loose cable does not make the lamps jump to and fro; a
// goodbye, or a lower priority from the desk itself, is meant, and acts at once.
//
// Times are those of one clock and only rise. In steady state nothing allocates. Thread:
// thread-bound.
class DmxMerge {
public:
    enum class Rule {
        Highest,  // HTP: the highest level of all
        Latest    // LTP: the level that was changed last. Whoever comes was at zero before.
    };
    struct Settings {
        Rule rule = Rule::Highest;
        int ownPriority = 100;
        Time settling = std::chrono::seconds(1);
    };
    static constexpr std::size_t kMostSenders = 16;  // more at once are not heard

    // Who has a say in what the universe carries.
    struct Charge {
        std::string_view sender;  // "": our own levels
        int priority = 100;
        bool settling = false;  // it fell silent, and its last levels hold for now
    };

    explicit DmxMerge(const Settings& settings);

    // Frames in the order of their arrival.
    void receive(const DmxFrame& frame);
    // From now on our own changes claim no slot (Rule::Latest): a desk keeps what it changed last.
    void claimNothing() { claims_ = false; }
    // What the universe carries at `now`, no earlier than all that was received. `own` and `out`
    // may be the same.
    void mergeAt(Time now, std::span<const std::uint8_t, 512> own, std::span<std::uint8_t, 512> out);
    // Who was in charge then: our own levels first, then the desks in the order of their coming.
    // Good until the next call of any method.
    std::span<const Charge> inCharge() const { return inCharge_; }

private:
    struct Source {
        std::string sender;
        int priority = 100;
        Time arrived{}, silence{};
        DmxSlots slots{};
        std::array<Time, 512> changed{};  // when each slot got its level
    };
    static void setSlots(Source& source, std::span<const std::uint8_t, 512> slots, Time when);
    bool isLive(const Source& source, Time now) const { return now - source.arrived <= source.silence; }

    Settings settings_;
    bool claims_ = true;
    Source own_;
    std::vector<Source> sources_;  // the first count_ are there, in the order of their coming
    std::size_t count_ = 0;
    std::vector<const Source*> winners_;
    std::vector<Charge> inCharge_;
};

}  // namespace fantascope::show
