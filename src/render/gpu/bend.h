#pragma once

#include "render/canvas/canvas_warp.h"
#include "render/gpu/handles.h"

#include "core/result.h"

#include <glm/mat3x3.hpp>

#include <filesystem>
#include <string>

namespace fantascope::render::gpu {

// A warp's mesh as vertex shaders look it up: how far each point of the picture is moved from where
// the keystone has it. Triangles are bent at their corners alone, so those who draw keep them
// small. Thread: the context's.
class Bend {
public:
    // What a vertex shader needs to call bent(clip), as loadProgram()'s definitions. Error: the
    // file cannot be read.
    static Result<std::string> definitions(const std::filesystem::path& shaders);
    // Canvas heights that a triangle's edge may be long: in a mesh of 4 x 4 points that are moved
    // by 50 pixels of 1080, what is between its ends is then a tenth of a pixel off.
    static constexpr double kLongestEdge = 1.0 / 32;

    Bend();

    // Takes the mesh of `place`, if its warp has one. No allocation after the first.
    void follow(const CanvasPlace& place);
    bool any() const { return any_; }
    // For the program in use, made with definitions().
    void use() const;

private:
    bool any_ = false;
    glm::mat3 pictureFromClip_{1};
    Texture moves_;  // clip units; from the picture's top left
    std::vector<glm::vec2> nodes_;
};

}  // namespace fantascope::render::gpu
