#pragma once

#include <glm/vec2.hpp>

#include <string>

namespace fantascope {

// Somebody else at the screen that DISPLAY names: a second client of the X server, who finds windows by their titles. (In a file
// of its own because X's headers define words like None and Bool.)
class Onlooker {
public:
    Onlooker();
    ~Onlooker();
    Onlooker(const Onlooker&) = delete;
    Onlooker& operator=(const Onlooker&) = delete;

    // Clicks on the window's close button.
    void close(const std::string& title);
    bool isVisible(const std::string& title);
    glm::ivec2 sizeOf(const std::string& title);
    // The colour that is on the screen, 0xrrggbb, at a pixel of the window counted from its top left.
    unsigned long colourAt(const std::string& title, int x, int y);

private:
    struct Impl;
    Impl* impl_;
};

}  // namespace fantascope
