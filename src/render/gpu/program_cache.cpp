#include "render/gpu/program_cache.h"

#include "render/gpu/shader_program.h"

namespace fantascope::render::gpu {
namespace {

template <class Load>
Result<unsigned> loadedOnce(std::map<std::string, Program>& programs, const std::string& key, Load load) {
    auto found = programs.find(key);
    if (found == programs.end()) {
        Program program = TRY(load());
        found = programs.emplace(key, std::move(program)).first;
    }
    return found->second.name();
}

}  // namespace

Result<unsigned> ProgramCache::compute(const std::string& shader, const std::string& definitions) {
    return loadedOnce(programs_, shader + "\n" + definitions, [&] { return loadProgram(shaders_ / shader, definitions); });
}

Result<unsigned> ProgramCache::drawing(const std::string& vertexShader, const std::string& fragmentShader,
                                       const std::string& definitions) {
    return loadedOnce(programs_, vertexShader + "\n" + fragmentShader + "\n" + definitions,
                      [&] { return loadProgram(shaders_ / vertexShader, shaders_ / fragmentShader, definitions); });
}

}  // namespace fantascope::render::gpu
