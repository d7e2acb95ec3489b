#include "render/gpu/shader_program.h"

#include "core/file.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <string>
#include <utility>

namespace fantascope::render::gpu {
namespace {

// A shader is needed only until its program is linked.
template <GLenum kStage>
struct ShaderKind {
    static unsigned create() { return glCreateShader(kStage); }
    static void destroy(unsigned name) { glDeleteShader(name); }
};

template <class GetParameter, class GetLog>
std::string logOf(unsigned name, GetParameter getParameter, GetLog getLog) {
    GLint length = 0;
    getParameter(name, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(length), '\0');
    getLog(name, length, &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    return log;
}

template <GLenum kStage>
Result<Handle<ShaderKind<kStage>>> compiled(const std::filesystem::path& file, const std::string& definitions) {
    std::string source = TRY(readFile(file));
    // Only comments may precede #version, so the definitions follow it. #line keeps the compiler's
    // line numbers those of the file.
    if (!definitions.empty()) source.insert(source.find('\n') + 1, definitions + "#line 2\n");
    Handle<ShaderKind<kStage>> shader;
    const char* text = source.data();
    const auto length = static_cast<GLint>(source.size());
    glShaderSource(shader.name(), 1, &text, &length);
    glCompileShader(shader.name());
    GLint good = GL_FALSE;
    glGetShaderiv(shader.name(), GL_COMPILE_STATUS, &good);
    if (good != GL_TRUE)
        return Error(fmt::format("{}: the shader does not compile:\n{}", file.string(),
                                 logOf(shader.name(), glGetShaderiv, glGetShaderInfoLog)));
    return shader;
}

// Links the attached shaders. `files`: for the message.
Result<Program> linked(Program program, const std::string& files) {
    glLinkProgram(program.name());
    GLint good = GL_FALSE;
    glGetProgramiv(program.name(), GL_LINK_STATUS, &good);
    if (good != GL_TRUE)
        return Error(fmt::format("{} do not link:\n{}", files, logOf(program.name(), glGetProgramiv, glGetProgramInfoLog)));
    return program;
}

}  // namespace

Result<Program> loadProgram(const std::filesystem::path& vertexShader, const std::filesystem::path& fragmentShader,
                            const std::string& definitions) {
    const auto vertex = TRY(compiled<GL_VERTEX_SHADER>(vertexShader, definitions));
    const auto fragment = TRY(compiled<GL_FRAGMENT_SHADER>(fragmentShader, definitions));
    Program program;
    glAttachShader(program.name(), vertex.name());
    glAttachShader(program.name(), fragment.name());
    Program whole = TRY(linked(std::move(program), fmt::format("{} and {}", vertexShader.string(), fragmentShader.string())));
    glDetachShader(whole.name(), vertex.name());
    glDetachShader(whole.name(), fragment.name());
    return whole;
}

Result<Program> loadProgram(const std::filesystem::path& computeShader, const std::string& definitions) {
    const auto compute = TRY(compiled<GL_COMPUTE_SHADER>(computeShader, definitions));
    Program program;
    glAttachShader(program.name(), compute.name());
    Program whole = TRY(linked(std::move(program), fmt::format("the parts of {}", computeShader.string())));
    glDetachShader(whole.name(), compute.name());
    return whole;
}

}  // namespace fantascope::render::gpu
