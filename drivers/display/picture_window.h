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

// A window of the desktop that shows one picture after the other, for a person who looks at work in
// progress, and hears what keys the person presses. It is no output: nobody waits for a refresh.
// Thread: the main thread.
class PictureWindow {
public:
    // A picture of other proportions than `size` gets black bars. Error: no X server, or no OpenGL
    // 4.5.
    static Result<std::unique_ptr<PictureWindow>> open(const std::string& title, glm::ivec2 size);
    ~PictureWindow();
    PictureWindow(const PictureWindow&) = delete;
    PictureWindow& operator=(const PictureWindow&) = delete;

    // Stored values.
    void show(const GreyImage& picture);
    // The next key that was pressed: ' ', '\x1b' for escape, which a window that was closed or lost
    // means too, or a letter. Never waits.
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
