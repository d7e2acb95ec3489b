#include "render/reference_picture.h"

#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace fantascope::render {
namespace {

// One facet on the canvas: x right, y down, z to the viewer.
struct Facet {
    glm::dvec3 a, b, c;
    glm::dvec3 light;  // linear
};

// The facet's height above the canvas at a point, if it covers the point.
std::optional<double> heightOver(const Facet& facet, glm::dvec2 point) {
    const auto area = [](glm::dvec2 u, glm::dvec2 v) { return u.x * v.y - u.y * v.x; };
    const glm::dvec2 a = facet.a, b = facet.b, c = facet.c;
    const double whole = area(b - a, c - a);
    if (whole == 0) return std::nullopt;
    const double ofB = area(point - a, c - a) / whole, ofC = area(b - a, point - a) / whole;
    if (ofB < 0 || ofC < 0 || ofB + ofC > 1) return std::nullopt;
    return facet.a.z + ofB * (facet.b.z - facet.a.z) + ofC * (facet.c.z - facet.a.z);
}

std::vector<Facet> facetsOf(const TriangleMesh& mesh, const pattern::InstancePose& pose, glm::dvec3 colour) {
    const glm::dmat3 canvasFromShape = pattern::canvasFromShape(pose);
    const auto placed = [&](std::uint32_t vertex) {
        return canvasFromShape * glm::dvec3(mesh.vertices[vertex]) + glm::dvec3(pose.centre, 0);
    };
    std::vector<Facet> facets;
    for (const glm::uvec3 t : mesh.triangles) facets.push_back({placed(t.x), placed(t.y), placed(t.z), colour});

    // Facets are lit from above, a little left, in front. They have three quarters of the colour,
    // and all of it when facing the light.
    const auto seenNormal = [](const Facet& facet) {
        const glm::dvec3 normal = glm::normalize(glm::cross(facet.b - facet.a, facet.c - facet.a));
        return normal.z < 0 ? -normal : normal;
    };
    const bool flat = std::all_of(facets.begin(), facets.end(), [&](const Facet& facet) {
        return std::abs(glm::dot(seenNormal(facet), seenNormal(facets[0]))) > 0.9999;
    });
    const glm::dvec3 towardsLight = glm::normalize(glm::dvec3(-0.4, -0.6, 0.7));
    for (Facet& facet : facets)
        if (!flat) facet.light *= 0.75 + 0.25 * std::max(glm::dot(seenNormal(facet), towardsLight), 0.0);
    return facets;
}

}  // namespace

CanvasUnderPixels::CanvasUnderPixels(const Warp& warp, glm::ivec2 size) : part_(warp.shape().part), size_(size) {
    for (int y = 0; y <= size.y; ++y)
        for (int x = 0; x <= size.x; ++x) corners_.push_back(warp.canvasFromProjector({x, y}));
}

std::optional<glm::dvec2> CanvasUnderPixels::at(glm::dvec2 pixel) const {
    const glm::ivec2 cell = glm::min(glm::ivec2(pixel), size_ - 1);
    const glm::dvec2 share = pixel - glm::dvec2(cell);
    const auto* top = &corners_[static_cast<std::size_t>(cell.y * (size_.x + 1) + cell.x)];
    const auto* bottom = top + size_.x + 1;
    if (!top[0] || !top[1] || !bottom[0] || !bottom[1]) return std::nullopt;
    const glm::dvec2 canvas = glm::mix(glm::mix(*top[0], *top[1], share.x), glm::mix(*bottom[0], *bottom[1], share.x), share.y);
    if (glm::any(glm::lessThan(canvas, part_.low)) || glm::any(glm::greaterThan(canvas, part_.high))) return std::nullopt;
    return canvas;
}

RgbaImage referencePicture(const pattern::ShapePattern& pattern, std::span<const pattern::InstancePose> poses, const Warp& warp,
                           glm::ivec2 size, int samples) {
    std::vector<std::vector<Facet>> instances;
    for (std::size_t i = 0; i < poses.size(); ++i)
        instances.push_back(facetsOf(pattern.shapes[pattern.instances[i].shape].mesh, poses[i], pattern.instances[i].colour));

    const auto lightAt = [&](glm::dvec2 point) -> glm::dvec3 {
        for (std::size_t i = poses.size(); i-- > 0;) {
            if (glm::distance(point, poses[i].centre) > poses[i].size) continue;  // outside the sphere around the shape
            double highest = -INFINITY;
            glm::dvec3 light(0);
            for (const Facet& facet : instances[i])
                if (const auto height = heightOver(facet, point); height && *height > highest) {
                    highest = *height;
                    light = facet.light;
                }
            if (highest > -INFINITY) return light;
        }
        return glm::dvec3(0);
    };

    const CanvasUnderPixels under(warp, size);
    RgbaImage picture(size.x, size.y);
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x) {
            glm::dvec3 light(0);
            for (int sample = 0; sample < samples * samples; ++sample) {
                const glm::dvec2 within((sample % samples + 0.5) / samples, (sample / samples + 0.5) / samples);
                if (const auto canvas = under.at(glm::dvec2(x, y) + within))
                    light += lightAt(*canvas * glm::dvec2(pattern.aspect(), 1));
            }
            light /= samples * samples;
            const auto stored = [](double linear) {
                return static_cast<std::uint8_t>(std::lround(255 * srgbFromLinear(static_cast<float>(linear))));
            };
            picture.at(x, y) = {stored(light.x), stored(light.y), stored(light.z), 255};
        }
    return picture;
}

}  // namespace fantascope::render
