#include "theatre/body/human_form.h"

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

// A tube along an axis, smooth through its cross-sections, with round ends. `along` and `across`
// select x, y or z; the discs are stretched along `across`.
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
    // Cubic Hermite curves with the slopes of Catmull & Rom 1974 interpolate the sections.
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

// A cone with round ends. Neither end contains the other.
struct Cone {
    dvec3 from{0};
    double fromRadius = 0;
    dvec3 to{0};
    double toRadius = 0;

    // The nearest point of the axis seen along the slant.
    double operator()(const dvec3& p) const {
        const dvec3 axis = to - from, q = p - from;
        const double length = glm::length(axis), slope = (fromRadius - toRadius) / length, along = glm::dot(q, axis) / length,
                     across = std::sqrt(std::max(0.0, glm::dot(q, q) - along * along));
        const double nearest = std::clamp(along + across * slope / std::sqrt(1 - slope * slope), 0.0, length);
        return std::sqrt((along - nearest) * (along - nearest) + across * across) -
               std::lerp(fromRadius, toRadius, nearest / length);
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

// The smooth union and the smooth difference of two forms. The blend acts where their surfaces are
// nearer to each other than `round`.
double joined(double a, double b, double round) {
    const double h = std::max(round - std::abs(a - b), 0.0) / round;
    return std::min(a, b) - 0.25 * round * h * h;
}
double without(double a, double b, double round) { return -joined(-a, b, round); }

constexpr int kAlongX = 0, kAlongY = 1, kAlongZ = 2;

// along, wide centre, thin centre, wide, radius
constexpr Section kTrunk[] = {
    {0.538, 0, -0.006, 0.033, 0.061}, {0.566, 0, -0.007, 0.031, 0.062}, {0.600, 0, -0.004, 0.024, 0.0595},
    {0.640, 0, 0.000, 0.019, 0.0575}, {0.690, 0, 0.001, 0.022, 0.0590}, {0.735, 0, 0.001, 0.028, 0.0595},
    {0.772, 0, -0.002, 0.031, 0.056}, {0.800, 0, -0.005, 0.026, 0.041},
};
constexpr Section kShoulder[] = {{0.000, -0.004, 0.800, 0.008, 0.033},
                                 {0.040, -0.004, 0.804, 0.007, 0.035},
                                 {0.080, -0.001, 0.809, 0.002, 0.0355},
                                 {0.108, 0, 0.812, 0, 0.0355}};
constexpr Section kArm[] = {
    {0.100, 0, 0.812, 0, 0.0355},          {0.135, 0.000, 0.812, 0, 0.0345}, {0.180, 0.000, 0.812, 0, 0.0315},
    {0.240, 0.000, 0.812, 0, 0.0290},      {0.285, 0, 0.812, 0, 0.0255},     {0.305, 0.000, 0.812, 0.0005, 0.0250},
    {0.335, 0.001, 0.812, 0.0010, 0.0245}, {0.385, 0, 0.812, 0.001, 0.0205}, {0.440, 0, 0.812, 0.002, 0.0160}};
constexpr Section kPalm[] = {{0.436, 0, 0.812, 0.002, 0.0155},
                             {0.455, 0.001, 0.812, 0.0065, 0.0135},
                             {0.475, 0.001, 0.812, 0.0095, 0.0115},
                             {0.486, 0.001, 0.812, 0.0105, 0.0100}};
constexpr Cone kFingers[] = {{{0.484, 0.812, 0.0135}, 0.0070, {0.521, 0.811, 0.0130}, 0.0056},
                             {{0.486, 0.812, 0.0045}, 0.0074, {0.532, 0.811, 0.0038}, 0.0058},
                             {{0.486, 0.812, -0.0045}, 0.0070, {0.526, 0.811, -0.0052}, 0.0056},
                             {{0.482, 0.811, -0.0115}, 0.0064, {0.511, 0.810, -0.0130}, 0.0050}};
constexpr Cone kThumb[] = {{{0.452, 0.808, 0.009}, 0.0110, {0.474, 0.806, 0.0220}, 0.0080},
                           {{0.474, 0.806, 0.0220}, 0.0080, {0.497, 0.806, 0.0275}, 0.0062}};

constexpr Section kLeg[] = {
    {0.528, 0.0500, -0.002, 0, 0.0495}, {0.460, 0.0515, 0.000, 0, 0.0470},  {0.400, 0.0520, 0.001, 0, 0.0425},
    {0.340, 0.0520, 0.001, 0, 0.0380},  {0.290, 0.0520, 0.001, 0, 0.0343},  {0.268, 0.0520, 0.000, 0, 0.0330},
    {0.225, 0.0520, -0.003, 0, 0.0325}, {0.170, 0.0520, -0.003, 0, 0.0292}, {0.110, 0.0520, -0.001, 0, 0.0247},
    {0.065, 0.0520, 0.000, 0, 0.0215},  {0.040, 0.0520, 0.000, 0, 0.0210}};
constexpr Section kFoot[] = {{-0.020, 0.052, 0.0185, 0.002, 0.0205},
                             {0.010, 0.0525, 0.0225, 0.002, 0.0230},
                             {0.045, 0.054, 0.0175, 0.008, 0.0190},
                             {0.080, 0.057, 0.0115, 0.013, 0.0130},
                             {0.100, 0.057, 0.0090, 0.013, 0.0105}};

constexpr Section kNeck[] = {{0.805, -0.006, 0, 0.001, 0.0345}, {0.850, -0.003, 0, 0, 0.0320}, {0.900, 0.001, 0, 0.002, 0.0320}};
constexpr Section kHead[] = {{0.893, 0.015, 0, 0.013, 0.0285},
                             {0.915, 0.009, 0, 0.012, 0.0370},
                             {0.935, 0.005, 0, 0.009, 0.0425},
                             {0.954, 0.003, 0, 0.007, 0.0445}};
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
    d = joined(d, Ellipsoid{{0.038, 0.752, 0.034}, {0.034, 0.026, 0.026}}(p), 0.012);
    d = joined(d, Ellipsoid{{0.044, 0.765, -0.038}, {0.030, 0.040, 0.022}}(p), 0.012);
    d = joined(d, Ellipsoid{{0.036, 0.518, -0.034}, {0.040, 0.040, 0.036}}(p), 0.015);
    return joined(d, Limb{kAlongX, 2, kShoulder}(p), 0.030);
}

double hand(const dvec3& p) {
    double fingers = joined(kThumb[0](p), kThumb[1](p), 0.003);
    for (const Cone& finger : kFingers) fingers = std::min(fingers, finger(p));
    return joined(Limb{kAlongX, 2, kPalm}(p), fingers, 0.005);
}

double head(const dvec3& p) {
    const double skull = joined(Limb{kAlongY, 2, kHead}(p), Cone{{0, 0.886, 0.038}, 0.014, {0, 0.886, 0.042}, 0.012}(p), 0.014);
    return joined(skull, Limb{kAlongY, 2, kNeck}(p), 0.012);
}

double withFace(double d, const dvec3& p) {
    d = joined(d, Ellipsoid{{0, 0.942, 0.047}, {0.030, 0.006, 0.009}}(p), 0.010);          // brow
    d = without(d, Ellipsoid{{0.016, 0.930, 0.057}, {0.011, 0.0075, 0.010}}(p), 0.008);    // eyes
    d = joined(d, Cone{{0, 0.936, 0.052}, 0.0045, {0, 0.916, 0.0600}, 0.0070}(p), 0.006);  // nose
    d = joined(d, Ellipsoid{{0, 0.900, 0.0515}, {0.014, 0.0055, 0.008}}(p), 0.007);        // mouth
    d = joined(d, Ellipsoid{{0.0455, 0.923, -0.003}, {0.005, 0.014, 0.009}}(p), 0.004);    // ears
    return d;
}

}  // namespace

HumanForm::HumanForm(const Body& body) {
    std::vector<dvec3> places;
    for (const Body::Joint& joint : body.joints)
        places.push_back(joint.offset + (places.empty() ? dvec3(0) : places[joint.parent]));
    const auto inFrame = [&](std::uint32_t joint, const dvec3& local) { return (places[joint] + local) / body.stature; };
    for (const Capsule& c : body.capsules) {
        const std::string_view joint = body.joints[c.joint].name;
        if (joint.ends_with("wrist") || joint.ends_with("ankle") || joint.starts_with("right")) continue;
        const auto end = [&](const Sphere& sphere) {
            return PlacedSphere{inFrame(sphere.joint, sphere.centre), sphere.radius / body.stature};
        };
        capsules_.push_back({end(body.spheres[c.from]), end(body.spheres[c.to])});
    }
}

double HumanForm::operator()(const dvec3& place) const {
    const dvec3 p(std::abs(place.x), place.y, place.z);
    double person = joined(trunk(p), Limb{kAlongY, 0, kLegUpwards}(p), 0.010);
    person = joined(joined(person, Limb{kAlongX, 2, kArm}(p), 0.012), head(p), 0.016);
    double capsules = std::numeric_limits<double>::infinity();
    for (const auto& [from, to] : capsules_)
        capsules = std::min(capsules, Cone{from.centre, from.radius, to.centre, to.radius}(p));
    const double between = std::lerp(person, capsules, 0.6);
    const double whole = joined(joined(between, hand(p), 0.010), Limb{kAlongZ, 0, kFoot}(p), 0.014);
    // The soles are flat.
    return std::max(withFace(whole, p), -p.y);
}

}  // namespace fantascope::theatre
