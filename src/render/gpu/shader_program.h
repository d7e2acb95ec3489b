#pragma once

#include "render/gpu/handles.h"

#include "core/result.h"

#include <filesystem>

namespace fantascope::render::gpu {

// A program of a vertex and a fragment shader, each read from its file. Error: names the file and gives the compiler's or
// linker's log.
Result<Program> loadProgram(const std::filesystem::path& vertexShader, const std::filesystem::path& fragmentShader);

}  // namespace fantascope::render::gpu
