#pragma once

#include "render/gpu/handles.h"

#include "core/result.h"

#include <filesystem>
#include <map>
#include <string>

namespace fantascope::render::gpu {

// The programs made from one folder's shaders, each loaded once and shared. Thread: the context's.
class ProgramCache {
public:
    explicit ProgramCache(std::filesystem::path shaders) : shaders_(std::move(shaders)) {}

    const std::filesystem::path& folder() const { return shaders_; }
    // OpenGL names of programs, which live as long as the cache. Error: as loadProgram().
    Result<unsigned> compute(const std::string& shader, const std::string& definitions);
    Result<unsigned> drawing(const std::string& vertexShader, const std::string& fragmentShader,
                             const std::string& definitions = {});

private:
    std::filesystem::path shaders_;
    std::map<std::string, Program> programs_;  // by file names and definitions
};

}  // namespace fantascope::render::gpu
