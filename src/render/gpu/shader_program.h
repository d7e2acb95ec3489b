#pragma once

#include "render/gpu/handles.h"

#include "core/result.h"

#include <filesystem>
#include <string>

namespace fantascope::render::gpu {

// A program of a vertex and a fragment shader, each read from its file, whose first line is the
// #version. `definitions`: lines of preprocessor for both, put after it. Error: names the file and
// gives the compiler's or linker's log.
Result<Program> loadProgram(const std::filesystem::path& vertexShader, const std::filesystem::path& fragmentShader,
                            const std::string& definitions = {});
// The same of a compute shader.
Result<Program> loadProgram(const std::filesystem::path& computeShader, const std::string& definitions);

}  // namespace fantascope::render::gpu
