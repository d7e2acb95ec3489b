#include "drivers/site/scene.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fantascope::site {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::size_t kMaxDepth = 60;  // levels of boxes; deeper triangles share one leaf
constexpr float kSkin = 1e-3f;         // metres, so that a surface does not shadow itself

// Distance along the ray to the triangle, or infinity (Möller & Trumbore 1997).
float meet(glm::vec3 origin, glm::vec3 direction, glm::vec3 corner, glm::vec3 edge1, glm::vec3 edge2) {
    const glm::vec3 p = glm::cross(direction, edge2);
    const float determinant = glm::dot(edge1, p);
    if (determinant == 0) return kInfinity;
    const glm::vec3 t = origin - corner, q = glm::cross(t, edge1);
    const float u = glm::dot(t, p) / determinant, v = glm::dot(direction, q) / determinant;
    if (u < 0 || v < 0 || u + v > 1) return kInfinity;
    const float distance = glm::dot(edge2, q) / determinant;
    return distance > 0 ? distance : kInfinity;
}

}  // namespace

Scene::Scene(const std::vector<SceneObject>& objects) {
    for (const SceneObject& object : objects) {
        const auto index = static_cast<std::uint32_t>(reflectances_.size());
        reflectances_.push_back(object.reflectance);
        textures_.push_back(object.texture);
        for (const glm::uvec3& corners : object.mesh.triangles) {
            const glm::vec3 a = object.mesh.vertices[corners.x], b = object.mesh.vertices[corners.y],
                            c = object.mesh.vertices[corners.z];
            triangles_.push_back({a, b - a, c - a, index});
        }
    }
    if (triangles_.empty()) return;
    nodes_.reserve(2 * triangles_.size());
    nodes_.emplace_back();
    divide(0, 0, static_cast<std::uint32_t>(triangles_.size()), 0);
}

// Splits the triangles by the surface area heuristic (MacDonald & Booth 1990), where rays are
// expected to meet the fewest. Beside a few huge sheets such as ground and wall, a split by count
// would put small triangles into large boxes.
void Scene::divide(std::uint32_t index, std::uint32_t begin, std::uint32_t end, std::size_t depth) {
    const auto sortAlong = [&](int axis) {
        std::sort(triangles_.begin() + begin, triangles_.begin() + end,
                  [&](const Triangle& a, const Triangle& b) { return a.centre()[axis] < b.centre()[axis]; });
    };
    const std::uint32_t count = end - begin;
    Box whole;
    for (std::uint32_t i = begin; i < end; ++i) whole.include(triangles_[i]);
    nodes_[index] = {whole, begin, count};

    float best = whole.area() * static_cast<float>(count);
    int bestAxis = -1;
    std::uint32_t middle = begin;
    std::vector<float> below(count);  // area of the box around the first i triangles
    for (int axis = 0; axis < 3; ++axis) {
        sortAlong(axis);
        Box box;
        for (std::uint32_t i = 0; i < count; ++i) {
            below[i] = box.area();
            box.include(triangles_[begin + i]);
        }
        box = {};
        for (std::uint32_t i = count - 1; i > 0; --i) {
            box.include(triangles_[begin + i]);
            const float cost = below[i] * static_cast<float>(i) + box.area() * static_cast<float>(count - i);
            if (cost >= best) continue;
            best = cost;
            bestAxis = axis;
            middle = begin + i;
        }
    }
    if (bestAxis < 0 || depth == kMaxDepth) return;
    sortAlong(bestAxis);
    const auto children = static_cast<std::uint32_t>(nodes_.size());
    nodes_[index].first = children;
    nodes_[index].count = 0;
    nodes_.resize(nodes_.size() + 2);
    divide(children, begin, middle, depth + 1);
    divide(children + 1, middle, end, depth + 1);
}

void Scene::Box::include(const Triangle& triangle) {
    for (const glm::vec3 point : {triangle.corner, triangle.corner + triangle.edge1, triangle.corner + triangle.edge2}) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }
}

float Scene::Box::area() const {
    const glm::vec3 side = glm::max(high - low, glm::vec3(0));
    return side.x * side.y + side.y * side.z + side.z * side.x;
}

template <class Test>
void Scene::visit(glm::vec3 origin, glm::vec3 direction, const float& limit, Test test) const {
    if (nodes_.empty()) return;
    const glm::vec3 inverse = 1.0f / direction;  // infinite along an axis; the slab test below still works
    const auto enters = [&](const Box& box) {
        const glm::vec3 a = (box.low - origin) * inverse, b = (box.high - origin) * inverse;
        const glm::vec3 first = glm::min(a, b), last = glm::max(a, b);
        const float in = std::max({first.x, first.y, first.z, 0.0f}), out = std::min({last.x, last.y, last.z, limit});
        return !(in > out);
    };
    std::array<std::uint32_t, kMaxDepth + 1> stack{};
    std::size_t waiting = 1;
    while (waiting > 0) {
        const Node& node = nodes_[stack[--waiting]];
        if (!enters(node.box)) continue;
        if (node.count == 0) {
            stack[waiting++] = node.first;
            stack[waiting++] = node.first + 1;
        }
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i)
            if (test(triangles_[i])) return;
    }
}

std::optional<Scene::Hit> Scene::nearest(glm::vec3 origin, glm::vec3 direction) const {
    float distance = kInfinity;
    const Triangle* met = nullptr;
    visit(origin, direction, distance, [&](const Triangle& triangle) {
        const float at = meet(origin, direction, triangle.corner, triangle.edge1, triangle.edge2);
        if (at < distance) {
            distance = at;
            met = &triangle;
        }
        return false;
    });
    if (met == nullptr) return std::nullopt;
    const glm::vec3 normal = glm::normalize(glm::cross(met->edge1, met->edge2));
    return Hit{distance,
               origin + direction * distance,
               glm::dot(normal, direction) > 0 ? -normal : normal,
               reflectances_[met->object],
               met->object,
               textures_[met->object].get()};
}

bool Scene::blocked(glm::vec3 from, glm::vec3 to) const {
    const float length = glm::length(to - from);
    const glm::vec3 direction = (to - from) / length;
    const float limit = length - kSkin;
    bool found = false;
    visit(from, direction, limit, [&](const Triangle& triangle) {
        const float at = meet(from, direction, triangle.corner, triangle.edge1, triangle.edge2);
        found = at > kSkin && at < limit;
        return found;
    });
    return found;
}

}  // namespace fantascope::site
