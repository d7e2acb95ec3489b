#pragma once

#include "core/clock.h"

#include <cstddef>
#include <memory>
#include <span>

namespace fantascope::vision {

// Tells ambient light on a picture from the light of the site's own lamps, whose levels are known.
// It learns how much light each lamp gives from what happens when the levels change (a Kalman
// filter of the base, of the rise of ambient light, and of each lamp's light at full level). Usual
// is the ambient light of the first measurements. Light is a share of the projector's full light,
// linear; levels are 0..1, linear. Thread: thread-bound.
class AmbientLight {
public:
    explicit AmbientLight(std::size_t lamps);
    ~AmbientLight();
    AmbientLight(AmbientLight&&) noexcept;
    AmbientLight& operator=(AmbientLight&&) noexcept;

    // Takes a measurement. `light`: all light that is not the picture's. By lamp, when the picture
    // was exposed: `given`, its level, and `asked`, what the cue asks of it. False: it is strange,
    // and does not count until that has lasted, so that headlights and people do not.
    bool see(double light, std::span<const float> given, std::span<const float> asked, Time at);
    // The lamps' light changes in a way that their levels do not tell: what is seen next is usual,
    // beside what was not before.
    void forgetBase();

    // Whether it is known what is usual.
    bool isKnown() const;
    struct Light {
        double mean = 0, sigma = 0;  // sigma: its standard deviation
        double most() const { return mean + 2 * sigma; }
    };
    // How much more ambient light there is than usual.
    Light rise() const;
    // How much of a light is beside what is usual with lamps at these levels.
    double excessOf(double light, std::span<const float> levels) const;
    // The light of the lamps at these levels, by what was learned of them.
    Light of(std::span<const float> levels) const;

private:
    struct Filter;
    std::unique_ptr<Filter> filter_;
};

}  // namespace fantascope::vision
