#include "theatre/human_form.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace fantascope::theatre {
namespace {

using glm::dvec3;

// A cross-section of a limb: a disc of a radius, stretched by `wide` to both sides.
struct Section {
    double along = 0, wideCentre = 0, thinCentre = 0, wide = 0, radius = 0;
};

// What runs along an axis through cross-sections, smoothly, and ends round. `along`, `across`: which of x, y, z; the discs are stretched along
// `across`.
struct Limb {
    int along = 1, across = 0;
    std::span<const Section> sections;

    double operator()(const dvec3& p) const {
        const Section at = section(p[along]);
        const double u = std::max(0.0, std::abs(p[across] - at.wideCentre) - at.wide), v = p[3 - along - across] - at.thinCentre,
                     s = p[along] - at.along;
        return std::sqrt(u * u + v * v + s * s) - at.radius;
    }

private:
    // Through the sections by cubic Hermite curves with the slopes of Catmull & Rom 1974.
    Section section(double along) const {
        if (along <= sections.front().along) return sections.front();
        if (along >= sections.back().along) return sections.back();
        std::size_t i = 0;
        while (along > sections[i + 1].along) ++i;
        const Section &a = sections[i], &b = sections[i + 1];
        const Section &before = sections[i == 0 ? 0 : i - 1], &after = sections[std::min(i + 2, sections.size() - 1)];
        const double length = b.along - a.along, t = (along - a.along) / length;
        const double ofB = t * t * (3 - 2 * t), inA = t * (1 - t) * (1 - t) * length, inB = -t * t * (1 - t) * length;
        const auto at = [&](double Section::*part) {
            const double slopeA = (b.*part - before.*part) / (b.along - before.along),
                         slopeB = (after.*part - a.*part) / (after.along - a.along);
            return a.*part + ofB * (b.*part - a.*part) + inA * slopeA + inB * slopeB;
        };
        return {along, at(&Section::wideCentre), at(&Section::thinCentre), at(&Section::wide), at(&Section::radius)};
    }
};

// A cone with round ends (Quilez, "round cone").
struct Cone {
    dvec3 from{0};
    double fromRadius = 0;
    dvec3 to{0};
    double toRadius = 0;

    double operator()(const dvec3& p) const {
        const dvec3 axis = to - from, q = p - from;
        const double ll = glm::dot(axis, axis), rr = fromRadius - toRadius, a2 = ll - rr * rr, y = glm::dot(q, axis), z = y - ll;
        const dvec3 across = q * ll - axis * y;
        const double x2 = glm::dot(across, across), y2 = y * y * ll, z2 = z * z * ll;
        const double k = std::copysign(rr * rr * x2, rr);
        if (std::copysign(a2 * z2, z) > k) return std::sqrt(x2 + z2) / ll - toRadius;
        if (std::copysign(a2 * y2, y) < k) return std::sqrt(x2 + y2) / ll - fromRadius;
        return (std::sqrt(x2 * a2 / ll) + y * rr) / ll - fromRadius;
    }
};

struct Ellipsoid {
    dvec3 centre{0}, radii{1};

    double operator()(const dvec3& p) const {
        const dvec3 q = (p - centre) / radii;
        const double k = glm::length(q), slope = glm::length(q / radii);
        return slope > 0 ? k * (k - 1) / slope : -radii.x;
    }
};

// The union of two forms, filled out where their surfaces are nearer to each other than `round`; and what is left when one is cut out.
double joined(double a, double b, double round) {
    const double h = std::max(round - std::abs(a - b), 0.0) / round;
    return std::min(a, b) - 0.25 * round * h * h;
}
double without(double a, double b, double round) { return -joined(-a, b, round); }

constexpr int kAlongX = 0, kAlongY = 1, kAlongZ = 2;

// along, wide centre, thin centre, wide, radius
constexpr Section kTrunk[] = {
    {0.530, 0, -0.006, 0.032, 0.060}, {0.562, 0, -0.008, 0.033, 0.062}, {0.600, 0, -0.004, 0.025, 0.059},
    {0.640, 0, 0.000, 0.019, 0.0565}, {0.690, 0, 0.001, 0.023, 0.058},  {0.735, 0, 0.002, 0.029, 0.059},
    {0.772, 0, 0.000, 0.031, 0.055},  {0.800, 0, -0.004, 0.026, 0.041},
};
constexpr Section kShoulder[] = {{0.000, -0.006, 0.800, 0.010, 0.036},
                                 {0.040, -0.006, 0.803, 0.008, 0.036},
                                 {0.080, -0.002, 0.808, 0.002, 0.035},
                                 {0.108, 0, 0.812, 0, 0.034}};
constexpr Section kArm[] = {
    {0.100, 0, 0.811, 0, 0.0335},          {0.135, 0.000, 0.811, 0, 0.0335}, {0.180, 0.001, 0.812, 0, 0.0305},
    {0.240, 0.001, 0.812, 0, 0.0280},      {0.285, 0, 0.812, 0, 0.0247},     {0.305, 0.000, 0.812, 0.001, 0.0245},
    {0.335, 0.001, 0.812, 0.0015, 0.0245}, {0.385, 0, 0.812, 0.002, 0.0200}, {0.440, 0, 0.812, 0.004, 0.0145}};
constexpr Section kPalm[] = {{0.436, 0, 0.812, 0.004, 0.0145},
                             {0.455, 0.001, 0.812, 0.0085, 0.0125},
                             {0.475, 0.001, 0.812, 0.0120, 0.0108},
                             {0.486, 0.001, 0.812, 0.0130, 0.0095}};
constexpr Cone kFingers[] = {{{0.484, 0.812, 0.0165}, 0.0070, {0.527, 0.811, 0.0200}, 0.0052},
                             {{0.486, 0.812, 0.0060}, 0.0072, {0.536, 0.811, 0.0070}, 0.0054},
                             {{0.486, 0.812, -0.0045}, 0.0070, {0.531, 0.811, -0.0065}, 0.0052},
                             {{0.482, 0.811, -0.0145}, 0.0064, {0.516, 0.810, -0.0195}, 0.0047}};
constexpr Cone kThumb[] = {{{0.452, 0.808, 0.010}, 0.0105, {0.476, 0.807, 0.0300}, 0.0075},
                           {{0.476, 0.807, 0.0300}, 0.0075, {0.500, 0.808, 0.0370}, 0.0058}};

constexpr Section kLeg[] = {
    {0.505, 0.0500, -0.003, 0, 0.0480}, {0.460, 0.0510, 0.000, 0, 0.0475},  {0.400, 0.0520, 0.002, 0, 0.0430},
    {0.340, 0.0520, 0.003, 0, 0.0375},  {0.290, 0.0520, 0.003, 0, 0.0328},  {0.268, 0.0520, 0.001, 0, 0.0318},
    {0.225, 0.0520, -0.005, 0, 0.0325}, {0.170, 0.0520, -0.006, 0, 0.0287}, {0.110, 0.0520, -0.004, 0, 0.0228},
    {0.065, 0.0520, -0.003, 0, 0.0198}, {0.040, 0.0520, -0.002, 0, 0.0195}};
constexpr Section kFoot[] = {{-0.022, 0.052, 0.0180, 0.002, 0.0195},
                             {0.010, 0.052, 0.0240, 0.002, 0.0250},
                             {0.045, 0.054, 0.0175, 0.008, 0.0190},
                             {0.080, 0.057, 0.0115, 0.014, 0.0130},
                             {0.102, 0.056, 0.0085, 0.014, 0.0100}};

constexpr Section kNeck[] = {{0.805, -0.010, 0, 0.002, 0.0360}, {0.850, -0.006, 0, 0, 0.0320}, {0.900, 0.000, 0, 0.002, 0.0315}};
constexpr Section kHead[] = {{0.893, 0.014, 0, 0.016, 0.0270},
                             {0.915, 0.008, 0, 0.014, 0.0360},
                             {0.935, 0.004, 0, 0.011, 0.0415},
                             {0.956, 0.002, 0, 0.009, 0.0430}};
// From the ends upwards.
template <std::size_t N>
constexpr std::array<Section, N> upwards(const Section (&sections)[N]) {
    std::array<Section, N> turned{};
    for (std::size_t i = 0; i < N; ++i) turned[i] = sections[N - 1 - i];
    return turned;
}
constexpr auto kLegUpwards = upwards(kLeg);

double trunk(const dvec3& p) {
    double d = Limb{kAlongY, 0, kTrunk}(p);
    // Breast, shoulder blades, buttocks.
    d = joined(d, Ellipsoid{{0.040, 0.752, 0.034}, {0.036, 0.026, 0.027}}(p), 0.012);
    d = joined(d, Ellipsoid{{0.044, 0.765, -0.038}, {0.030, 0.040, 0.022}}(p), 0.012);
    d = joined(d, Ellipsoid{{0.036, 0.515, -0.034}, {0.040, 0.042, 0.036}}(p), 0.015);
    return joined(d, Limb{kAlongX, 2, kShoulder}(p), 0.030);
}

double arm(const dvec3& p) {
    double hand = Limb{kAlongX, 2, kPalm}(p);
    double fingers = std::numeric_limits<double>::infinity();
    for (const Cone& finger : kFingers) fingers = std::min(fingers, finger(p));
    hand = joined(hand, fingers, 0.004);
    double thumb = joined(kThumb[0](p), kThumb[1](p), 0.003);
    hand = joined(hand, thumb, 0.008);
    return joined(Limb{kAlongX, 2, kArm}(p), hand, 0.010);
}

double leg(const dvec3& p) {
    const double foot = Limb{kAlongZ, 0, kFoot}(p);
    // The soles are flat.
    return std::max(joined(Limb{kAlongY, 0, kLegUpwards}(p), foot, 0.014), -p.y);
}

double head(const dvec3& p) {
    double d = Limb{kAlongY, 2, kHead}(p);
    d = joined(d, Cone{{0, 0.888, 0.040}, 0.014, {0, 0.888, 0.043}, 0.012}(p), 0.012);     // chin
    d = joined(d, Ellipsoid{{0, 0.941, 0.048}, {0.030, 0.006, 0.009}}(p), 0.008);          // brow
    d = without(d, Ellipsoid{{0.017, 0.930, 0.056}, {0.010, 0.006, 0.008}}(p), 0.006);     // eyes
    d = joined(d, Cone{{0, 0.934, 0.052}, 0.0045, {0, 0.916, 0.0605}, 0.0065}(p), 0.006);  // nose
    d = joined(d, Ellipsoid{{0, 0.900, 0.050}, {0.013, 0.005, 0.008}}(p), 0.006);          // mouth
    d = joined(d, Ellipsoid{{0.0445, 0.922, -0.003}, {0.005, 0.015, 0.009}}(p), 0.004);    // ears
    return joined(d, Limb{kAlongY, 2, kNeck}(p), 0.012);
}

}  // namespace

double humanForm(const dvec3& place) {
    const dvec3 p(std::abs(place.x), place.y, place.z);
    const double body = joined(joined(trunk(p), leg(p), 0.020), arm(p), 0.026);
    return joined(body, head(p), 0.022);
}

}  // namespace fantascope::theatre
