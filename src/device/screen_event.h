#pragma once

#include "core/clock.h"

#include <glm/vec2.hpp>

namespace fantascope {

// A key of a keyboard: the character that it types without Shift, or its name.
struct Key {
    enum class Name { Letter, Left, Right, Up, Down, Tab, Enter, Escape, Backspace };
    Name name = Name::Letter;
    char letter = 0;  // printable ASCII, lower case, for Name::Letter
    bool shift = false, control = false;
    friend bool operator==(const Key&, const Key&) = default;
};

// Keyboard or pointer input at a display. A held key repeats KeyDown.
struct ScreenEvent {
    enum class Kind { KeyDown, KeyUp, PointerMoved, ButtonDown, ButtonUp };  // the button: the left mouse button
    Kind kind = Kind::KeyDown;
    Key key{};
    glm::dvec2 at{0.0};  // position of the pointer in pixels of the surface, y down
    Time moment{};       // when it happened, on the display's clock
};

}  // namespace fantascope
