#include "drivers/display/picture_window.h"

#include <epoxy/gl.h>

#define GLFW_INCLUDE_NONE  // epoxy brings OpenGL
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace fantascope::drivers {

Result<std::unique_ptr<PictureWindow>> PictureWindow::open(const std::string& title, glm::ivec2 size) {
    auto library = TRY(GlfwLibrary::shared());
    GLFWwindow* const window = TRY(library->makeWindow(title, size));
    return std::unique_ptr<PictureWindow>(new PictureWindow(std::move(library), window));
}

PictureWindow::PictureWindow(std::shared_ptr<GlfwLibrary> library, GLFWwindow* window)
    : library_(std::move(library)), window_(window) {
    glfwSwapInterval(0);
    glfwSetWindowUserPointer(window_, this);
    glfwSetCharCallback(window_, [](GLFWwindow* which, unsigned letter) {
        if (letter < 128)
            static_cast<PictureWindow*>(glfwGetWindowUserPointer(which))->keys_.push_back(static_cast<char>(letter));
    });
    glfwSetKeyCallback(window_, [](GLFWwindow* which, int key, int, int action, int) {
        if (key == GLFW_KEY_ESCAPE && action == GLFW_PRESS)
            static_cast<PictureWindow*>(glfwGetWindowUserPointer(which))->keys_.push_back('\x1b');
    });
    glCreateFramebuffers(1, &framebuffer_);
}

PictureWindow::~PictureWindow() {
    glfwDestroyWindow(window_);  // and its context with everything in it
}

void PictureWindow::show(const GreyImage& picture) {
    if (!library_->pollEvents()) return;
    glfwMakeContextCurrent(window_);
    const glm::ivec2 size(picture.width(), picture.height());
    if (size != textureSize_) {
        glDeleteTextures(1, &texture_);
        glCreateTextures(GL_TEXTURE_2D, 1, &texture_);
        glTextureStorage2D(texture_, 1, GL_RGBA8, size.x, size.y);
        glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, texture_, 0);
        textureSize_ = size;
    }
    std::vector<std::uint8_t> pixels;
    pixels.reserve(4 * picture.pixels().size());
    for (const float value : picture.pixels()) {
        const auto stored = static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0f, 1.0f)));
        pixels.insert(pixels.end(), {stored, stored, stored, 255});
    }
    glTextureSubImage2D(texture_, 0, 0, 0, size.x, size.y, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());

    glm::ivec2 window(0);
    glfwGetFramebufferSize(window_, &window.x, &window.y);
    const double scale = std::min(double(window.x) / size.x, double(window.y) / size.y);
    const glm::ivec2 shown = glm::max(glm::ivec2(glm::dvec2(size) * scale + 0.5), glm::ivec2(1)), corner = (window - shown) / 2;
    const GLfloat black[] = {0, 0, 0, 1};
    glClearNamedFramebufferfv(0, GL_COLOR, 0, black);
    // Row 0 is the picture's top, but OpenGL's bottom.
    glBlitNamedFramebuffer(framebuffer_, 0, 0, 0, size.x, size.y, corner.x, corner.y + shown.y, corner.x + shown.x, corner.y,
                           GL_COLOR_BUFFER_BIT, GL_LINEAR);
    if (library_->pollEvents()) glfwSwapBuffers(window_);
}

std::optional<char> PictureWindow::pollKey() {
    if ((!library_->pollEvents() || library_->destroyed(window_) || glfwWindowShouldClose(window_)) &&
        !std::exchange(closed_, true))
        keys_.push_back('\x1b');
    if (keys_.empty()) return std::nullopt;
    const char key = keys_.front();
    keys_.pop_front();
    return key;
}

}  // namespace fantascope::drivers
