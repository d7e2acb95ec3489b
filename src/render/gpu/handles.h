#pragma once

#include "core/result.h"

#include <utility>

namespace fantascope::render::gpu {

// While it exists, handles and fences on this thread are destroyed without OpenGL calls: they were
// lost with their context.
class Forgetting {
public:
    Forgetting() : before_(std::exchange(on_, true)) {}
    ~Forgetting() { on_ = before_; }
    Forgetting(const Forgetting&) = delete;
    Forgetting& operator=(const Forgetting&) = delete;
    static bool on() { return on_; }

private:
    static thread_local bool on_;
    bool before_;
};

// Owns one OpenGL object; typed, so that a buffer cannot be used as a framebuffer. It is created
// and destroyed while its context is current, and must not outlive it. Thread: the context's.
template <class Kind>
class Handle {
public:
    Handle() : name_(Kind::create()) {}
    ~Handle() {
        if (name_ != 0 && !Forgetting::on()) Kind::destroy(name_);
    }
    Handle(Handle&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    Handle& operator=(Handle&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }
    unsigned name() const { return name_; }

private:
    unsigned name_;
};

struct BufferKind {
    static unsigned create();
    static void destroy(unsigned name);
};
struct VertexArrayKind {
    static unsigned create();
    static void destroy(unsigned name);
};
struct RenderbufferKind {
    static unsigned create();
    static void destroy(unsigned name);
};
struct TextureKind {  // two-dimensional
    static unsigned create();
    static void destroy(unsigned name);
};
struct Texture3Kind {  // three-dimensional
    static unsigned create();
    static void destroy(unsigned name);
};
struct MultisampleTextureKind {
    static unsigned create();
    static void destroy(unsigned name);
};
struct FramebufferKind {
    static unsigned create();
    static void destroy(unsigned name);
};
struct ProgramKind {
    static unsigned create();
    static void destroy(unsigned name);
};

using Buffer = Handle<BufferKind>;
using VertexArray = Handle<VertexArrayKind>;
using Renderbuffer = Handle<RenderbufferKind>;
using Texture = Handle<TextureKind>;
using Texture3 = Handle<Texture3Kind>;
using MultisampleTexture = Handle<MultisampleTextureKind>;
using Framebuffer = Handle<FramebufferKind>;
using Program = Handle<ProgramKind>;

// Error: OpenGL has run out of memory since the last call, so objects created since may be
// unusable.
Result<void> checkMemory();

// A point in OpenGL's command stream that can be polled or waited for. Empty until set().
class Fence {
public:
    Fence() = default;
    ~Fence() { clear(); }
    Fence(Fence&& other) noexcept : sync_(std::exchange(other.sync_, nullptr)) {}
    Fence& operator=(Fence&& other) noexcept {
        std::swap(sync_, other.sync_);
        return *this;
    }
    // Sets the point behind all commands so far.
    void set();
    // Whether the point has been passed. Flushes, so that it eventually is; never waits. An empty
    // fence has been passed.
    bool passed();
    // Waits until the point has been passed and empties the fence. Returns at once if it is empty.
    void wait();

private:
    void clear();
    void* sync_ = nullptr;  // GLsync
};

}  // namespace fantascope::render::gpu
