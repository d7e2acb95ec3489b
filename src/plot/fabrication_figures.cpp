#include "plot/fabrication_figures.h"

#include "core/geometry.h"
#include "plot/palette.h"
#include "plot/rendering.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace fantascope::plot {
namespace {

using glm::dvec2, glm::dvec3;
using theatre::Fabrication;

constexpr glm::vec3 kTable{0.80f, 0.83f, 0.87f}, kPlastic{0.55f, 0.53f, 0.50f};  // linear light

}  // namespace

RgbaImage fabricationView(const Fabrication& print, int width, int height) {
    TriangleMesh mesh = print.mesh;
    std::vector<dvec3> points;
    for (glm::vec3& v : mesh.vertices) {
        v = {v.x, v.z, -v.y};  // y up
        points.emplace_back(v);
    }
    const Camera camera = Camera::fitting(points, {-0.45, -0.55, -1}, radians(30), double(width) / height, 0.05);
    const glm::vec3 key = glm::normalize(glm::vec3(-0.5f, 0.8f, 0.5f)), eye(camera.position);
    const Surface surface{std::move(mesh), [=](const glm::vec3& place, const glm::vec3& normal) {
                              const float direct = std::max(0.0f, glm::dot(normal, key)),
                                          facing = std::max(0.0f, glm::dot(normal, glm::normalize(eye - place)));
                              return glm::vec4(kPlastic * (0.25f + 0.15f * normal.y + 0.75f * direct) * (0.6f + 0.4f * facing),
                                               1);
                          }};
    return rendered(std::array{surface}, camera, kTable, width, height);
}

Page fabricationSheet(const Fabrication&, const theatre::PoseTarget&) { return Page(842, 595); }

}  // namespace fantascope::plot
