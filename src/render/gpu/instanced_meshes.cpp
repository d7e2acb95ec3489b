#include "render/gpu/instanced_meshes.h"

#include <epoxy/gl.h>

#include <cstdint>
#include <type_traits>

namespace fantascope::render::gpu {
namespace {

static_assert(std::is_trivially_copyable_v<Instance> && sizeof(Instance) == 22 * sizeof(float), "the shader reads packed floats");

// The attribute locations of assets/shaders/shape.vert, and the buffer binding points of a vertex
// array.
enum : GLuint { kPosition = 0, kNormal = 1, kClipFromShape = 2, kTowardsLight = 6, kColour = 7 };
enum : GLuint { kPerVertex = 0, kPerInstance = 1 };

void attribute(GLuint vertexArray, GLuint binding, GLuint location, GLint components, std::size_t offset) {
    glEnableVertexArrayAttrib(vertexArray, location);
    glVertexArrayAttribFormat(vertexArray, location, components, GL_FLOAT, GL_FALSE, static_cast<GLuint>(offset));
    glVertexArrayAttribBinding(vertexArray, location, binding);
}

}  // namespace

InstancedMeshes::InstancedMeshes(std::span<const Mesh> meshes, bool mirrored) : mirrored_(mirrored) {
    std::vector<FacetVertex> vertices;
    std::vector<std::uint32_t> indices;
    for (const Mesh& mesh : meshes) {
        if (mesh.instances == 0) continue;
        parts_.push_back({static_cast<unsigned>(mesh.mesh.indices.size()), static_cast<unsigned>(indices.size()),
                          static_cast<int>(vertices.size()), static_cast<unsigned>(mesh.instances),
                          static_cast<unsigned>(instanceCount_), mesh.mesh.closed});
        vertices.insert(vertices.end(), mesh.mesh.vertices.begin(), mesh.mesh.vertices.end());
        indices.insert(indices.end(), mesh.mesh.indices.begin(), mesh.mesh.indices.end());
        instanceCount_ += mesh.instances;
    }
    if (parts_.empty()) return;

    glNamedBufferStorage(vertices_.name(), static_cast<GLsizeiptr>(std::span(vertices).size_bytes()), vertices.data(), 0);
    glNamedBufferStorage(indices_.name(), static_cast<GLsizeiptr>(std::span(indices).size_bytes()), indices.data(), 0);
    const auto bytes = static_cast<GLsizeiptr>(kFramesInFlight * instanceCount_ * sizeof(Instance));
    constexpr GLbitfield kAccess = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    glNamedBufferStorage(instances_.name(), bytes, nullptr, kAccess);
    mapped_ = static_cast<Instance*>(glMapNamedBufferRange(instances_.name(), 0, bytes, kAccess));

    const GLuint array = vertexArray_.name();
    glVertexArrayElementBuffer(array, indices_.name());
    glVertexArrayVertexBuffer(array, kPerVertex, vertices_.name(), 0, sizeof(FacetVertex));
    glVertexArrayVertexBuffer(array, kPerInstance, instances_.name(), 0, sizeof(Instance));
    glVertexArrayBindingDivisor(array, kPerInstance, 1);
    attribute(array, kPerVertex, kPosition, 3, offsetof(FacetVertex, position));
    attribute(array, kPerVertex, kNormal, 3, offsetof(FacetVertex, normal));
    for (GLuint column = 0; column < 4; ++column)
        attribute(array, kPerInstance, kClipFromShape + column, 4,
                  offsetof(Instance, clipFromShape) + column * sizeof(glm::vec4));
    attribute(array, kPerInstance, kTowardsLight, 3, offsetof(Instance, towardsLight));
    attribute(array, kPerInstance, kColour, 3, offsetof(Instance, colour));
}

std::span<Instance> InstancedMeshes::place() {
    frame_ = (frame_ + 1) % kFramesInFlight;
    drawn_[frame_].wait();
    return {mapped_ + frame_ * instanceCount_, instanceCount_};
}

void InstancedMeshes::draw() {
    glBindVertexArray(vertexArray_.name());
    glFrontFace(mirrored_ ? GL_CW : GL_CCW);
    for (const Part& part : parts_) {
        // Half of a closed surface faces away; without culling, a software OpenGL spends half of
        // its time on it.
        (part.closed ? glEnable : glDisable)(GL_CULL_FACE);
        glDrawElementsInstancedBaseVertexBaseInstance(GL_TRIANGLES, static_cast<GLsizei>(part.indexCount), GL_UNSIGNED_INT,
                                                      reinterpret_cast<const void*>(part.firstIndex * sizeof(std::uint32_t)),
                                                      static_cast<GLsizei>(part.instanceCount), part.firstVertex,
                                                      static_cast<GLuint>(frame_ * instanceCount_) + part.firstInstance);
    }
    drawn_[frame_].set();
}

}  // namespace fantascope::render::gpu
