#pragma once

#include "render/gpu/handles.h"
#include "render/gpu/instanced_meshes.h"

#include "core/result.h"

#include <array>
#include <filesystem>
#include <glm/vec3.hpp>

namespace fantascope::render::gpu {

// How the light of what is painted meets the picture.
enum class Light {
    Alone,  // the picture is black so far
    Added   // as a second projector would add it
};

// Paints instanced meshes: opaque to each other, the nearest instance on top. Thread: the context's.
class ShapePainter {
public:
    // Error: a shader in `shaders` is missing or does not compile.
    static Result<ShapePainter> create(const std::filesystem::path& shaders);

    // Paints into the current target with all colours times `opacity`. `inside`: four half planes that bound what is lit; a point with
    // clip coordinates (x, y, z, w) is in when dot(inside[i], (x, y, w)) >= 0 for each.
    void paint(InstancedMeshes& meshes, const std::array<glm::vec3, 4>& inside, float opacity, Light light);

private:
    explicit ShapePainter(Program program) : program_(std::move(program)) {}
    Program program_;
};

}  // namespace fantascope::render::gpu
