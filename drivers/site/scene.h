#pragma once

#include "drivers/site/texture.h"

#include "vision/camera_model.h"

#include "media/mesh.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::site {

// An object in the site.
struct SceneObject {
    TriangleMesh mesh;                            // world metres
    glm::vec3 reflectance{0.5};                   // of a matt surface, linear RGB, 0..1
    std::string name = {};                        // for people
    std::shared_ptr<const Texture> texture = {};  // multiplies the reflectance; null: 1
};

// All surfaces of the site, for ray queries. Immutable; thread-safe.
class Scene {
public:
    explicit Scene(const std::vector<SceneObject>& objects);

    struct Hit {
        float distance = 0;
        glm::vec3 point{0}, normal{0};  // unit, on the ray's side: every surface has two sides
        glm::vec3 reflectance{0};
        std::size_t object = 0;  // index of the object
        const Texture* texture = nullptr;
    };
    // The first surface along the ray. `direction` is unit.
    std::optional<Hit> nearest(glm::vec3 origin, glm::vec3 direction) const;
    // Whether a surface blocks the line between two points; surfaces within a millimetre of either
    // do not count.
    bool blocked(glm::vec3 from, glm::vec3 to) const;

private:
    struct Triangle {
        glm::vec3 corner, edge1, edge2;
        std::uint32_t object;
        glm::vec3 centre() const { return corner + (edge1 + edge2) / 3.0f; }
    };
    struct Box {
        glm::vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};
        void include(const Triangle& triangle);
        float area() const;  // half of its surface; 0: empty
    };
    // A node of a tree of boxes; an inner node's children are at `first` and first + 1.
    struct Node {
        Box box;
        std::uint32_t first = 0;  // triangle or child
        std::uint32_t count = 0;  // of triangles; 0: an inner node
    };
    void divide(std::uint32_t node, std::uint32_t begin, std::uint32_t end, std::size_t depth);
    // Calls test(triangle) for each triangle whose box the ray enters before `limit`, until test
    // returns true. test may lower `limit`.
    template <class Test>
    void visit(glm::vec3 origin, glm::vec3 direction, const float& limit, Test test) const;

    std::vector<glm::vec3> reflectances_;                   // of the objects
    std::vector<std::shared_ptr<const Texture>> textures_;  // of the objects
    std::vector<Triangle> triangles_;
    std::vector<Node> nodes_;
};

}  // namespace fantascope::site
