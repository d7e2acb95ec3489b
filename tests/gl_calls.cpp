#include "gl_calls.h"

#include <epoxy/gl.h>

#include <type_traits>

namespace fantascope {
namespace {

std::int64_t programsMade = 0, objectsMade = 0;

// epoxy calls through pointers that anybody may set; this one counts and calls what was there.
template <auto& pointer, std::int64_t& count, class Function = std::remove_reference_t<decltype(pointer)>>
struct Counted;
template <auto& pointer, std::int64_t& count, class R, class... Arguments>
struct Counted<pointer, count, R (*)(Arguments...)> {
    static inline R (*before)(Arguments...) = nullptr;
    static R call(Arguments... arguments) {
        ++count;
        return before(arguments...);
    }
    static void begin() {
        before = pointer;
        pointer = call;
    }
    static void end() {
        if (pointer == call) pointer = before;
    }
};

// Of the functions that make something.
void forEach(auto act) {
    act(Counted<glCreateShader, programsMade>{});
    act(Counted<glCompileShader, programsMade>{});
    act(Counted<glCreateProgram, programsMade>{});
    act(Counted<glLinkProgram, programsMade>{});
    act(Counted<glCreateShaderProgramv, programsMade>{});
    act(Counted<glCreateBuffers, objectsMade>{});
    act(Counted<glGenBuffers, objectsMade>{});
    act(Counted<glCreateTextures, objectsMade>{});
    act(Counted<glGenTextures, objectsMade>{});
    act(Counted<glCreateFramebuffers, objectsMade>{});
    act(Counted<glGenFramebuffers, objectsMade>{});
    act(Counted<glCreateRenderbuffers, objectsMade>{});
    act(Counted<glGenRenderbuffers, objectsMade>{});
    act(Counted<glCreateVertexArrays, objectsMade>{});
    act(Counted<glGenVertexArrays, objectsMade>{});
    act(Counted<glCreateSamplers, objectsMade>{});
    act(Counted<glGenSamplers, objectsMade>{});
    act(Counted<glCreateQueries, objectsMade>{});
    act(Counted<glGenQueries, objectsMade>{});
    act(Counted<glNamedBufferStorage, objectsMade>{});
    act(Counted<glNamedBufferData, objectsMade>{});
    act(Counted<glBufferData, objectsMade>{});
    act(Counted<glTextureStorage2D, objectsMade>{});
    act(Counted<glTextureStorage3D, objectsMade>{});
    act(Counted<glTextureStorage2DMultisample, objectsMade>{});
    act(Counted<glNamedRenderbufferStorage, objectsMade>{});
    act(Counted<glNamedRenderbufferStorageMultisample, objectsMade>{});
}

}  // namespace

GlCalls::GlCalls() {
    programsMade = objectsMade = 0;
    forEach([](auto function) { function.begin(); });
}
GlCalls::~GlCalls() {
    forEach([](auto function) { function.end(); });
}
std::int64_t GlCalls::programs() const { return programsMade; }
std::int64_t GlCalls::objects() const { return objectsMade; }

}  // namespace fantascope
