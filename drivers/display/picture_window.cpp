#include "drivers/display/picture_window.h"

#include <epoxy/gl.h>

#define GLFW_INCLUDE_NONE  // epoxy brings OpenGL
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::drivers {

Result<std::unique_ptr<PictureWindow>> PictureWindow::open(const std::string& title, glm::ivec2 size) {
    auto library = TRY(GlfwLibrary::shared());
    GLFWwindow* const window = TRY(library->makeWindow(title, size));
    return std::unique_ptr<PictureWindow>(new PictureWindow(std::move(library), window));
}

Result<void> PictureWindow::check() {
    const auto library = TRY(GlfwLibrary::shared());
    glfwDestroyWindow(TRY(library->makeWindow("Fantascope", {16, 16}, {{GLFW_VISIBLE, GLFW_FALSE}})));
    return {};
}

PictureWindow::PictureWindow(std::shared_ptr<GlfwLibrary> library, GLFWwindow* window)
    : library_(std::move(library)), window_(window) {
    glfwSwapInterval(0);
    listen();
    glCreateFramebuffers(1, &framebuffer_);
}

PictureWindow::~PictureWindow() {
    glfwDestroyWindow(window_);  // and its context with everything in it
}

void PictureWindow::listen() {
    glfwSetWindowUserPointer(window_, this);
    static constexpr auto of = [](GLFWwindow* window) { return static_cast<PictureWindow*>(glfwGetWindowUserPointer(window)); };
    glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int scanCode, int action, int modifiers) {
        if (const auto known = pressedKey(key, scanCode, modifiers))
            of(window)->give(action == GLFW_RELEASE ? ScreenEvent::Kind::KeyUp : ScreenEvent::Kind::KeyDown, *known);
    });
    glfwSetCursorPosCallback(window_, [](GLFWwindow* window, double x, double y) {
        of(window)->pointer_ = {x, y};
        of(window)->give(ScreenEvent::Kind::PointerMoved);
    });
    glfwSetMouseButtonCallback(window_, [](GLFWwindow* window, int button, int action, int) {
        if (button == GLFW_MOUSE_BUTTON_LEFT)
            of(window)->give(action == GLFW_PRESS ? ScreenEvent::Kind::ButtonDown : ScreenEvent::Kind::ButtonUp);
    });
}

void PictureWindow::give(ScreenEvent::Kind kind, const Key& key) {
    const bool moves = kind == ScreenEvent::Kind::PointerMoved;
    // Of moves on end the newest is enough: the pointer moves more often than pictures are drawn.
    if (moves && !events_.empty() && events_.back().kind == kind) events_.pop_back();
    events_.push_back({kind, key, pointer_, {}});
}

bool PictureWindow::isThere() {
    const bool lost = !library_->pollEvents();
    if (!absence_.empty()) return false;
    if (lost)
        absence_ = "the X server has ended";
    else if (library_->destroyed(window_))
        absence_ = "another program has destroyed the window";
    else if (glfwWindowShouldClose(window_))
        absence_ = "the window was closed";
    return absence_.empty();
}

void PictureWindow::show(const GreyImage& picture) {
    RgbaImage colours(picture.width(), picture.height());
    for (std::size_t i = 0; i < picture.pixels().size(); ++i) {
        const auto stored = static_cast<std::uint8_t>(std::lround(255 * std::clamp(picture.pixels()[i], 0.0f, 1.0f)));
        colours.pixels()[i] = {stored, stored, stored, 255};
    }
    show(colours);
}

void PictureWindow::show(const RgbaImage& picture) {
    if (!isThere()) return;
    glfwMakeContextCurrent(window_);
    const glm::ivec2 size(picture.width(), picture.height());
    if (size != textureSize_) {
        glDeleteTextures(1, &texture_);
        glCreateTextures(GL_TEXTURE_2D, 1, &texture_);
        glTextureStorage2D(texture_, 1, GL_RGBA8, size.x, size.y);
        glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, texture_, 0);
        textureSize_ = size;
    }
    glTextureSubImage2D(texture_, 0, 0, 0, size.x, size.y, GL_RGBA, GL_UNSIGNED_BYTE, picture.pixels().data());

    glm::ivec2 window(0);
    glfwGetFramebufferSize(window_, &window.x, &window.y);
    scale_ = std::max(1e-3, std::min(double(window.x) / size.x, double(window.y) / size.y));
    const glm::ivec2 shown = glm::max(glm::ivec2(glm::dvec2(size) * scale_ + 0.5), glm::ivec2(1)), corner = (window - shown) / 2;
    corner_ = glm::dvec2(corner);
    const GLfloat black[] = {0, 0, 0, 1};
    glClearNamedFramebufferfv(0, GL_COLOR, 0, black);
    // Row 0 is the picture's top, but OpenGL's bottom.
    glBlitNamedFramebuffer(framebuffer_, 0, 0, 0, size.x, size.y, corner.x, corner.y + shown.y, corner.x + shown.x, corner.y,
                           GL_COLOR_BUFFER_BIT, GL_LINEAR);
    if (isThere()) glfwSwapBuffers(window_);
}

std::optional<ScreenEvent> PictureWindow::pollEvent() {
    (void)isThere();
    if (events_.empty()) return std::nullopt;
    ScreenEvent event = events_.front();
    events_.pop_front();
    event.at = (event.at - corner_) / scale_;
    return event;
}

std::optional<char> PictureWindow::pollKey() {
    constexpr char kEscape = '\x1b';
    while (const auto event = pollEvent()) {
        if (event->kind != ScreenEvent::Kind::KeyDown) continue;
        if (event->key.name == Key::Name::Escape) return kEscape;
        if (event->key.name == Key::Name::Letter && !event->key.control) return event->key.letter;
    }
    if (absence_.empty() || std::exchange(told_, true)) return std::nullopt;
    return kEscape;
}

}  // namespace fantascope::drivers
