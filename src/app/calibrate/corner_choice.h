#pragma once

#include "app/calibrate/corner_picture.h"

#include "device/screen_event.h"

#include "media/image.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// A person chooses where a canvas is to stand in the camera's picture, with pointer and keys. It
// begins with the place that the program would take. Corners that are moved lie on tenths of a
// camera pixel, inside the picture. Thread: thread-bound.
class CornerChoice {
public:
    // `title`: what is said above the picture.
    CornerChoice(OpenPlace place, std::string title);
    CornerChoice(const CornerChoice&) = delete;
    CornerChoice& operator=(const CornerChoice&) = delete;

    // What the person did at a window that shows picture(), in its pixels.
    void take(const ScreenEvent& event);

    enum class State { Open, Taken, GivenUp };
    State state() const { return state_; }
    // Camera pixels, clockwise from the canvas's top left; fewer than four while the person sets
    // new ones.
    const std::vector<glm::dvec2>& corners() const { return corners_; }
    std::size_t chosen() const { return chosen_; }  // the corner that keys move
    // Why the place cannot be taken as it is, and what to do; empty: it can be.
    std::string obstacle() const;
    RgbaImage picture() const;

private:
    struct Step {
        std::vector<glm::dvec2> corners;
        std::size_t chosen;
    };
    struct Drag {
        glm::dvec2 from, offset;  // where it began, and from the pointer to the corner; pixels of the picture
        bool moves, remembered;   // whether it is more than a click, and whether it can be taken back
    };
    void press(const Key& key);
    void grab(glm::dvec2 at);
    void drag(glm::dvec2 at);
    void move(glm::dvec2 to, bool& remembered);
    void remember();
    void undo();
    void enter();

    const OpenPlace place_;
    const std::string title_;
    const CornerPicture picture_;
    std::vector<glm::dvec2> corners_;
    std::size_t chosen_ = 0;
    std::vector<Step> steps_;         // that can be taken back
    std::optional<Drag> drag_;        // while the button is held
    std::optional<Key::Name> arrow_;  // while it is held
    bool arrowRemembered_ = false;
    bool refused_ = false;
    State state_ = State::Open;
};

}  // namespace fantascope::app
