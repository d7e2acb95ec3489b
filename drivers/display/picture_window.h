#pragma once

#include "drivers/display/glfw_library.h"

#include "device/screen_event.h"

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
// and reports what the person does. It is not an output: nobody waits for a refresh.
// Thread: the main thread.
class PictureWindow {
public:
    // A picture of another aspect than `size` gets black bars. Error: no X server, or no OpenGL
    // 4.5.
    static Result<std::unique_ptr<PictureWindow>> open(const std::string& title, glm::ivec2 size);
    // Whether open() works now. Nothing appears on the screen. Error: as of open().
    static Result<void> check();
    ~PictureWindow();
    PictureWindow(const PictureWindow&) = delete;
    PictureWindow& operator=(const PictureWindow&) = delete;

    // The picture holds stored values.
    void show(const RgbaImage& picture);
    void show(const GreyImage& picture);
    // The next keyboard or pointer event, oldest first, in pixels of the last picture and without
    // its moment. Never waits.
    std::optional<ScreenEvent> pollEvent();
    // The same for who needs keys alone: ' ', a letter, or '\x1b' for Escape, which also means that
    // the window is gone.
    std::optional<char> pollKey();
    // Why there is no window any more, as the end of a sentence; empty: there is one. It does not
    // come back.
    const std::string& absence() const { return absence_; }

private:
    PictureWindow(std::shared_ptr<GlfwLibrary> library, GLFWwindow* window);

    void listen();
    void give(ScreenEvent::Kind kind, const Key& key = {});
    bool isThere();

    std::shared_ptr<GlfwLibrary> library_;
    GLFWwindow* window_;
    unsigned texture_ = 0, framebuffer_ = 0;
    glm::ivec2 textureSize_{0};
    glm::dvec2 corner_{0.0};  // of the picture in the window, window pixels
    double scale_ = 1;        // window pixels for one of the picture
    glm::dvec2 pointer_{0.0};
    std::deque<ScreenEvent> events_;  // in window pixels
    std::string absence_;
    bool told_ = false;  // that it is gone, by pollKey()
};

}  // namespace fantascope::drivers
