#pragma once

#include "render/gpu/bend.h"
#include "render/gpu/handles.h"
#include "render/gpu/instanced_meshes.h"

#include "core/result.h"

#include <glm/vec3.hpp>

#include <array>
#include <filesystem>

namespace fantascope::render::gpu {

// Paints instanced meshes into a LayerPicture: opaque, the nearest on top. Thread: the context's.
class ShapePainter {
public:
    // Error: a shader in the folder `shaders` is missing or does not compile.
    static Result<ShapePainter> create(const std::filesystem::path& shaders);

    // Paints into the current layer picture. `inside`: four half planes that clip it; a point with
    // clip coordinates (x, y, z, w) is inside if dot(inside[i], (x, y, w)) >= 0 for each i. `bend`:
    // the mesh on top of the keystone, or null.
    void paint(InstancedMeshes& meshes, const std::array<glm::vec3, 4>& inside, const Bend* bend);

private:
    ShapePainter(Program straight, Program bent) : straight_(std::move(straight)), bent_(std::move(bent)) {}
    Program straight_, bent_;
};

}  // namespace fantascope::render::gpu
