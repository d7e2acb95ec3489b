#pragma once

#include "show/course/lamp_trim.h"
#include "vision/watch/ambient_light.h"

#include "core/clock.h"

#include <optional>

namespace fantascope::app {

// What is known of the other light on the pictures when a picture was exposed. Light is a share of
// the projectors' full light, linear.
struct TrimSight {
    Time at{};  // show time
    using Light = vision::AmbientLight::Light;
    Light ambient{};              // how much more ambient light there is than usual
    double excess = 0;            // other light beside what is usual with the lamps that the cue asks for
    double total = 0;             // all other light, above the camera's dark
    Light fixtures{}, full{};     // of the fixtures that may be dimmed: at the levels that the cue asks for; at full level
    double share = 1;             // of their levels that was given
    std::optional<Light> next{};  // of the relay that would be switched off next; nothing: there is none
    std::optional<Light> last{};  // of the relay that was switched off last
    bool maySwitch = false;       // relays may be switched now
};

// The loop that holds the other light on the pictures by trimming the site's own lamps. Every 2.3 s
// it moves the share by 0.4 of what would take the excess away if the lamps gave as much light as
// they possibly do: what was learned of it and twice its uncertainty, but no more than all other
// light. So the gain of the loop is at most 0.4 if light follows the level linearly, and 0.8 if it
// grows with its square; and a delay of half a second is a part of one step. It does not overshoot.
// A small excess moves nothing. Relays are switched off one after the other once the fixtures are
// at their limit, and none that may take away more than is missed.
// Thread: thread-bound.
class TrimLoop {
public:
    struct Bounds {
        double least = 0.3;   // of the share
        double speed = 0.02;  // of the share, 1/s
    };
    explicit TrimLoop(const Bounds& bounds) : bounds_(bounds) {}

    // The trim that the lamps should move to. `goal`: the one that they move to now.
    show::LampTrim step(const TrimSight& sight, const show::LampTrim& goal);

    // An excess that is not worth a movement.
    static double deadBandOf(const TrimSight& sight);
    // Whether dimming the fixtures makes a difference.
    static bool isWorthIt(const TrimSight& sight);

private:
    double shareFor(const TrimSight& sight, double goal);
    int relayStep(const TrimSight& sight);

    Bounds bounds_;
    std::optional<Time> decided_;
    bool moves_ = false;
    int wish_ = 0;  // of relays: 1: one more should be off; -1: one should come on again
    Time wishedSince_{};
};

}  // namespace fantascope::app
