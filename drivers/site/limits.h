#pragma once

#include "core/clock.h"
#include "core/config/config.h"

#include <optional>

namespace fantascope::site {

// What the `simulation:` section accepts at most.
constexpr double kMaxDistance = 1000;  // metres from the origin
constexpr double kMaxTime = 1e6;       // seconds: eleven days
constexpr double kMaxLight = 1e6;      // lux, candela, lumens, cd/m2

// A beginning and an end; `until` is after `at`. Call check() after finish().
struct Span {
    Time& at;
    std::optional<Time>& until;

    void declare(ConfigFields& fields) const {
        fields.time("at", at, 0, kMaxTime);
        fields.optional().read("until", until, [](const ConfigNode& value) -> Result<Time> {
            return fromSeconds(TRY(value.number(0, kMaxTime, "s")));
        });
    }
    Result<void> check(const ConfigNode& node) const {
        if (until && *until <= at) return node.error("'until' must be later than 'at'");
        return {};
    }
};

}  // namespace fantascope::site
