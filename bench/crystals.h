#pragma once
// Swaying crystals for benchmarks, of any number and fineness.

#include "render/source/picture_source.h"

#include "core/check.h"
#include "core/random.h"
#include "core/result.h"

#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <utility>

namespace fantascope::render {

// The value; a benchmark ends on an error.
template <class T>
T valueOf(Result<T> result) {
    FANTASCOPE_CHECK(result.has_value(), result.error().message());
    return std::move(result).value();
}

// A closed crystal of 2 * segments * (rings - 1) facets.
inline TriangleMesh crystal(std::uint32_t segments, std::uint32_t rings) {
    TriangleMesh mesh;
    mesh.vertices.push_back({0, 1, 0});
    for (std::uint32_t ring = 1; ring < rings; ++ring)
        for (std::uint32_t segment = 0; segment < segments; ++segment) {
            const double polar = std::numbers::pi * ring / rings, around = 2 * std::numbers::pi * segment / segments;
            mesh.vertices.push_back({std::sin(polar) * std::cos(around), std::cos(polar), std::sin(polar) * std::sin(around)});
        }
    mesh.vertices.push_back({0, -1, 0});
    const auto bottom = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    for (std::uint32_t segment = 0; segment < segments; ++segment) {
        const std::uint32_t next = (segment + 1) % segments;
        mesh.triangles.push_back({0, 1 + next, 1 + segment});
        for (std::uint32_t ring = 0; ring + 2 < rings; ++ring) {
            const std::uint32_t upper = 1 + ring * segments, lower = upper + segments;
            mesh.triangles.push_back({upper + segment, upper + next, lower + segment});
            mesh.triangles.push_back({upper + next, lower + next, lower + segment});
        }
        mesh.triangles.push_back({bottom, bottom - segments + segment, bottom - segments + next});
    }
    return mesh;
}

struct Crystals {
    int count;
    std::uint32_t segments = 6, rings = 6;  // 60 facets
    double largest = 0.06;                  // canvas heights
};
// On a canvas of 16:9.
inline PatternSource swayingCrystals(const Crystals& crystals) {
    pattern::ShapePattern pattern;
    pattern.width = 640;
    pattern.height = 360;
    pattern.shapes.push_back({"crystal", crystal(crystals.segments, crystals.rings)});
    Rng rng(1);
    for (std::uint32_t id = 0; id < static_cast<std::uint32_t>(crystals.count); ++id) {
        pattern::ShapeInstance instance;
        instance.id = id;
        instance.centre = {rng.uniform(0, pattern.aspect()), rng.uniform()};
        instance.size = rng.uniform(crystals.largest / 3, crystals.largest);
        instance.rotation = {rng.uniform(0, 3), rng.uniform(0, 3), rng.uniform(0, 3)};
        pattern.instances.push_back(instance);
    }
    const auto shared = std::make_shared<const pattern::ShapePattern>(std::move(pattern));
    return {shared, std::make_shared<const pattern::PatternMotion>(*shared)};
}

}  // namespace fantascope::render
