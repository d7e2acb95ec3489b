#pragma once

namespace fantascope::site {

// What the `simulation:` section accepts at most.
constexpr double kMaxDistance = 1000;  // metres from the origin
constexpr double kMaxTime = 1e6;       // seconds: eleven days
constexpr double kMaxLight = 1e6;      // lux, candela, lumens, cd/m2

}  // namespace fantascope::site
