#include "render/gpu/handles.h"

#include <epoxy/gl.h>

namespace fantascope::render::gpu {
namespace {

template <class Create>
unsigned created(Create create) {
    GLuint name = 0;
    create(1, &name);
    return name;
}

}  // namespace

thread_local bool Forgetting::on_ = false;

unsigned BufferKind::create() { return created(glCreateBuffers); }
void BufferKind::destroy(unsigned name) { glDeleteBuffers(1, &name); }
unsigned VertexArrayKind::create() { return created(glCreateVertexArrays); }
void VertexArrayKind::destroy(unsigned name) { glDeleteVertexArrays(1, &name); }
unsigned RenderbufferKind::create() { return created(glCreateRenderbuffers); }
void RenderbufferKind::destroy(unsigned name) { glDeleteRenderbuffers(1, &name); }
unsigned TextureKind::create() {
    return created([](GLsizei count, GLuint* names) { glCreateTextures(GL_TEXTURE_2D, count, names); });
}
void TextureKind::destroy(unsigned name) { glDeleteTextures(1, &name); }
unsigned Texture3Kind::create() {
    return created([](GLsizei count, GLuint* names) { glCreateTextures(GL_TEXTURE_3D, count, names); });
}
void Texture3Kind::destroy(unsigned name) { glDeleteTextures(1, &name); }
unsigned MultisampleTextureKind::create() {
    return created([](GLsizei count, GLuint* names) { glCreateTextures(GL_TEXTURE_2D_MULTISAMPLE, count, names); });
}
void MultisampleTextureKind::destroy(unsigned name) { glDeleteTextures(1, &name); }
unsigned FramebufferKind::create() { return created(glCreateFramebuffers); }
void FramebufferKind::destroy(unsigned name) { glDeleteFramebuffers(1, &name); }
unsigned ProgramKind::create() { return glCreateProgram(); }
void ProgramKind::destroy(unsigned name) { glDeleteProgram(name); }

Result<void> checkMemory() {
    constexpr int kMaxErrors = 8;  // OpenGL remembers one error of each kind
    for (int errors = 0; errors < kMaxErrors; ++errors) {
        const GLenum error = glGetError();
        if (error == GL_NO_ERROR) return {};
        if (error == GL_OUT_OF_MEMORY) break;
    }
    return Error("OpenGL has no memory left; make the output or its pictures smaller, or close other programs");
}

void Fence::set() {
    clear();
    sync_ = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
}

bool Fence::passed() {
    if (sync_ == nullptr) return true;
    if (glClientWaitSync(static_cast<GLsync>(sync_), GL_SYNC_FLUSH_COMMANDS_BIT, 0) == GL_TIMEOUT_EXPIRED) return false;
    clear();
    return true;
}

void Fence::wait() {
    if (sync_ == nullptr) return;
    glClientWaitSync(static_cast<GLsync>(sync_), GL_SYNC_FLUSH_COMMANDS_BIT, GL_TIMEOUT_IGNORED);
    clear();
}

void Fence::clear() {
    void* const sync = std::exchange(sync_, nullptr);
    if (sync != nullptr && !Forgetting::on()) glDeleteSync(static_cast<GLsync>(sync));
}

}  // namespace fantascope::render::gpu
