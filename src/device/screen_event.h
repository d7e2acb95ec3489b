#pragma once

#include "core/clock.h"

#include <glm/vec2.hpp>

namespace fantascope {

// A key of a keyboard as a person knows it: what it writes without Shift, or its name.
struct Key {
    enum class Name { Letter, Left, Right, Up, Down, Tab, Enter, Escape };
    Name name = Name::Letter;
    char letter = 0;  // printable ASCII in small letters, for Name::Letter
    bool shift = false, control = false;
    friend bool operator==(const Key&, const Key&) = default;
};

// What a person does at a display. A key that is held comes down again and again.
struct ScreenEvent {
    enum class Kind { KeyDown, KeyUp, PointerMoved, ButtonDown, ButtonUp };  // the button: the mouse's first
    Kind kind = Kind::KeyDown;
    Key key{};
    glm::dvec2 at{0.0};  // of the pointer, in the surface's pixels, y down
    Time moment{};       // on the display's clock
};

}  // namespace fantascope
