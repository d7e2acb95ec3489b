#pragma once

#include "render/canvas/canvas_warp.h"
#include "render/gpu/handles.h"

#include "core/result.h"

#include <glm/mat3x3.hpp>

#include <filesystem>
#include <string>

namespace fantascope::render::gpu {

// A warp's mesh as a table for vertex shaders: the offset of each point of the picture from where
// the keystone has it. It bends triangles only at their corners, so callers keep triangles small.
// Thread: the context's.
class Bend {
public:
    // The definitions for loadProgram() that let a vertex shader call bent(clip). Error: the file
    // cannot be read.
    static Result<std::string> definitions(const std::filesystem::path& shaders);
    // Maximum length of a triangle's edge, canvas heights. In a mesh of 4 x 4 points with offsets
    // of 50 pixels of 1080, the error along such an edge is a tenth of a pixel.
    static constexpr double kLongestEdge = 1.0 / 32;

    Bend();

    // Takes over the mesh of `place`, if its warp has one. Allocates only in the first call.
    void follow(const CanvasPlace& place);
    bool any() const { return any_; }
    // Binds the table for the current program, which was made with definitions().
    void use() const;

private:
    bool any_ = false;
    glm::mat3 pictureFromClip_{1};
    Texture moves_;  // offsets in clip units; from the picture's top left
    std::vector<glm::vec2> nodes_;
};

}  // namespace fantascope::render::gpu
