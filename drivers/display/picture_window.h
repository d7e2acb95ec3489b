#pragma once

#include "drivers/display/glfw_library.h"

#include "core/result.h"
#include "media/image.h"

#include <glm/vec2.hpp>

#include <deque>
#include <memory>
#include <optional>
#include <string>

struct GLFWwindow;

namespace fantascope::drivers {

// A desktop window that shows one picture after another to a person who watches work in progress,
// and reports the keys that the person presses. It is not an output: nobody waits for a refresh.
// Thread: the main thread.
class PictureWindow {
public:
    // A picture of another aspect than `size` gets black bars. Error: no X server, or no OpenGL
    // 4.5.
    static Result<std::unique_ptr<PictureWindow>> open(const std::string& title, glm::ivec2 size);
    ~PictureWindow();
    PictureWindow(const PictureWindow&) = delete;
    PictureWindow& operator=(const PictureWindow&) = delete;

    // The picture holds stored values.
    void show(const GreyImage& picture);
    // The next pressed key: ' ', a letter, or '\x1b' for Escape, which also means that the window
    // was closed or lost. Never waits.
    std::optional<char> pollKey();

private:
    PictureWindow(std::shared_ptr<GlfwLibrary> library, GLFWwindow* window);

    std::shared_ptr<GlfwLibrary> library_;
    GLFWwindow* window_;
    unsigned texture_ = 0, framebuffer_ = 0;
    glm::ivec2 textureSize_{0};
    std::deque<char> keys_;
    bool closed_ = false;
};

}  // namespace fantascope::drivers
