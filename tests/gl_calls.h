#pragma once

#include <cstdint>

namespace fantascope {

// Counts calls of OpenGL in this program that make something, while it lives. One at a time, made
// once OpenGL was used: the functions are found at their first call. What the driver does on its
// own account, and calls that GLFW makes, are not seen.
class GlCalls {
public:
    GlCalls();
    ~GlCalls();
    GlCalls(const GlCalls&) = delete;
    GlCalls& operator=(const GlCalls&) = delete;

    std::int64_t programs() const;  // shaders and programs made, compiled or linked
    std::int64_t objects() const;   // buffers, textures and the like made, or given memory; fences do not count
};

}  // namespace fantascope
