#include "render/gpu/bend.h"

#include "core/file.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <glm/gtc/type_ptr.hpp>
#include <glm/matrix.hpp>

namespace fantascope::render::gpu {
namespace {

// The lattice is so fine that interpolation between its nodes may be linear.
constexpr int kNodes = 129;

// Uniform location and texture unit of assets/shaders/bend.glsl.
constexpr GLint kPictureFromClip = 40;
constexpr GLuint kMoves = 15;

}  // namespace

Result<std::string> Bend::definitions(const std::filesystem::path& shaders) {
    return fmt::format("#define BENT\n#define NODES {}\n{}", kNodes, TRY(readFile(shaders / "bend.glsl")));
}

Bend::Bend() : nodes_(kNodes * kNodes) {
    glTextureStorage2D(moves_.name(), 1, GL_RG32F, kNodes, kNodes);
    glTextureParameteri(moves_.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(moves_.name(), GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTextureParameteri(moves_.name(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

void Bend::follow(const CanvasPlace& place) {
    any_ = place.warp.bends();
    if (!any_) return;
    pictureFromClip_ = glm::inverse(clipFromPicture(place));
    const glm::dvec2 clipFromPixels = glm::dvec2(2, -2) / glm::dvec2(place.size);
    for (int y = 0; y < kNodes; ++y)
        for (int x = 0; x < kNodes; ++x)
            nodes_[static_cast<std::size_t>(y * kNodes + x)] =
                clipFromPixels * place.warp.offsetAt(glm::dvec2(x, y) / double(kNodes - 1));
    glTextureSubImage2D(moves_.name(), 0, 0, 0, kNodes, kNodes, GL_RG, GL_FLOAT, nodes_.data());
}

void Bend::use() const {
    glUniformMatrix3fv(kPictureFromClip, 1, GL_FALSE, glm::value_ptr(pictureFromClip_));
    glBindTextureUnit(kMoves, moves_.name());
}

}  // namespace fantascope::render::gpu
