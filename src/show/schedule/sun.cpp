#include "show/schedule/sun.h"

#include <chrono>
#include <cmath>
#include <numbers>

namespace fantascope::show {

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double radians(double degrees) { return degrees * kPi / 180; }

// Where the sun stands in the sky of a place.
struct Sun {
    double altitude;   // radians
    double hourAngle;  // radians, -pi..pi; 0: noon
};

Sun sunAt(Time utc, double latitude, double longitude) {
    constexpr double kCentury = 36525.0 * 86400;             // s
    constexpr Time k2000 = std::chrono::seconds(946728000);  // 2000-01-01 12:00 UTC
    constexpr double kDynamicalTime = 69;                    // s ahead of UTC, 2020 .. 2030; moves the sun by .001 degrees
    const double since = std::chrono::duration<double>(utc - k2000).count();
    const double t = (since + kDynamicalTime) / kCentury;

    // Chapter 25: geometric longitude, equation of the centre, apparent longitude, obliquity.
    const double mean = 280.46646 + t * (36000.76983 + t * 0.0003032);
    const double anomaly = radians(357.52911 + t * (35999.05029 - t * 0.0001537));
    const double centre = std::sin(anomaly) * (1.914602 - t * (0.004817 + t * 0.000014)) +
                          std::sin(2 * anomaly) * (0.019993 - t * 0.000101) + std::sin(3 * anomaly) * 0.000289;
    const double node = radians(125.04 - 1934.136 * t);
    const double apparent = radians(mean + centre - 0.00569 - 0.00478 * std::sin(node));
    const double obliquity = radians(23.4392911 - t * 0.0130042 + 0.00256 * std::cos(node));
    const double ascension = std::atan2(std::cos(obliquity) * std::sin(apparent), std::cos(apparent));
    const double declination = std::asin(std::sin(obliquity) * std::sin(apparent));

    // Chapter 12: sidereal time at Greenwich, with the nutation in longitude.
    const double sidereal =
        radians(280.46061837 + 360.98564736629 * (since / 86400) - 0.00478 * std::sin(node) * std::cos(obliquity));
    const double hourAngle = std::remainder(sidereal + longitude - ascension, 2 * kPi);
    const double altitude =
        std::asin(std::sin(latitude) * std::sin(declination) + std::cos(latitude) * std::cos(declination) * std::cos(hourAngle));
    return {altitude, hourAngle};
}

double altitudeOf(SunEvent event) {
    switch (event) {
        case SunEvent::Sunset:
        case SunEvent::Sunrise:
            return radians(-50.0 / 60);  // 34' of refraction, and half of the sun
        case SunEvent::CivilDusk:
        case SunEvent::CivilDawn:
            return radians(-6);
        case SunEvent::NauticalDusk:
        case SunEvent::NauticalDawn:
            return radians(-12);
        case SunEvent::AstronomicalDusk:
        case SunEvent::AstronomicalDawn:
            break;
    }
    return radians(-18);
}

}  // namespace

std::optional<Time> timeOf(SunEvent event, Time noon, double latitude, double longitude) {
    constexpr std::chrono::duration<double> kHalfTurn = std::chrono::hours(12);
    // The moment nearest to `near` at which the sun is at an hour angle.
    const auto turned = [&](Time near, double hourAngle) {
        for (int i = 0; i < 3; ++i) {
            const double off = std::remainder(sunAt(near, latitude, longitude).hourAngle - hourAngle, 2 * kPi);
            near -= std::chrono::duration_cast<Time>(kHalfTurn * (off / kPi));
        }
        return near;
    };
    const Time highest = turned(noon, 0), lowest = turned(highest + std::chrono::hours(12), kPi);
    const bool isEvening = event <= SunEvent::AstronomicalDusk;
    Time above = isEvening ? highest : turned(highest + std::chrono::hours(24), 0), below = lowest;
    const auto isAbove = [&](Time utc) { return sunAt(utc, latitude, longitude).altitude > altitudeOf(event); };
    if (!isAbove(above) || isAbove(below)) return std::nullopt;
    while (std::chrono::abs(above - below) > std::chrono::milliseconds(1)) {
        const Time middle = above + (below - above) / 2;
        (isAbove(middle) ? above : below) = middle;
    }
    return below;
}

}  // namespace fantascope::show
