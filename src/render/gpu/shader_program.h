#pragma once

#include "render/gpu/handles.h"

#include "core/result.h"

#include <filesystem>
#include <string>

namespace fantascope::render::gpu {

// Loads a program of a vertex and a fragment shader from their files, whose first lines are the
// #version. `definitions`: preprocessor lines for both, inserted after the first line. Error: names
// the file and gives the compiler's or linker's log.
Result<Program> loadProgram(const std::filesystem::path& vertexShader, const std::filesystem::path& fragmentShader,
                            const std::string& definitions = {});
// The same for a compute shader.
Result<Program> loadProgram(const std::filesystem::path& computeShader, const std::string& definitions);

}  // namespace fantascope::render::gpu
