#include "drivers/site/lamp.h"

#include "drivers/site/limits.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace fantascope::site {
namespace {

constexpr std::size_t kSteps = 4096;

}  // namespace

double Lamp::intensity(glm::dvec3 direction) const {
    const double p = std::log(std::log(10.0) / std::log(2.0)) / std::log(field / beam);
    const double a = beam / 2 / std::pow(std::log(2.0), 1 / p);
    const double angle = std::acos(std::clamp(glm::dot(direction, aim), -1.0, 1.0));
    return candela * std::exp(-std::pow(angle / a, p));
}

Beam::Beam(const Lamp& lamp) {
    Lamp level = lamp;
    level.aim = {1, 0, 0};
    for (std::size_t step = 0; step <= kSteps; ++step) {
        const double angle = 2 * std::asin(static_cast<double>(step) / kSteps);
        table_.push_back(static_cast<float>(level.intensity({std::cos(angle), std::sin(angle), 0})));
    }
}

float Beam::at(float cosine) const {
    const float place = std::sqrt(std::max(0.0f, (1 - cosine) / 2)) * static_cast<float>(kSteps);
    const std::size_t below = std::min(static_cast<std::size_t>(place), kSteps - 1);
    return table_[below] + (table_[below + 1] - table_[below]) * (place - static_cast<float>(below));
}

Result<Lamp> readLamp(const ConfigNode& node) {
    Lamp lamp;
    glm::dvec3 lookAt{0.0};
    ConfigFields fields(node);
    fields.vector3("position", lamp.position, -kMaxDistance, kMaxDistance, "m");
    fields.vector3("look_at", lookAt, -kMaxDistance, kMaxDistance, "m");
    declareBeam(fields, lamp);
    fields.number("candela", lamp.candela, 0, kMaxLight, "cd");
    TRY(fields.finish());
    TRY(checkBeam(lamp, node));
    if (glm::length(lookAt - lamp.position) < 1e-6) return node.error("look_at must differ from position");
    lamp.aim = glm::normalize(lookAt - lamp.position);
    return lamp;
}

void declareBeam(ConfigFields& fields, Lamp& lamp) {
    fields.angle("beam_angle", lamp.beam, 1, 175);
    fields.angle("field_angle", lamp.field, 1, 180);
    fields.optional().vector3("colour", lamp.colour, 0, 1);
    fields.optional().number("radius", lamp.radius, 0.001, 10, "m");
}

Result<void> checkBeam(const Lamp& lamp, const ConfigNode& node) {
    if (lamp.field <= lamp.beam) return node.error("field_angle must be larger than beam_angle");
    return {};
}

}  // namespace fantascope::site
