#pragma once
// What a technician sees on a projector while setting it up.

#include "media/image.h"
#include "media/projection.h"

#include <glm/vec2.hpp>

#include <optional>
#include <string>
#include <vector>

namespace fantascope::plot {

// One output as it is edited. Texts are UTF-8.
struct EditView {
    // What can be moved.
    struct Handle {
        glm::dvec2 at{0.0};  // projector pixels
        std::string label{};
        bool chosen = false;
    };

    const Projection& projection;  // its size and warp count
    double aspect = 16.0 / 9;      // of the whole canvas, width / height: outputs that share a canvas have one grid
    std::string name{};            // of the output
    int number = 1;
    TestPicture picture = TestPicture::None;
    std::vector<Handle> handles{};
    std::optional<glm::dvec2> pointer{};  // the mouse, projector pixels
    std::vector<std::string> lines{};     // what is being edited, in words: the first is the headline
    bool masks = false;                   // their outlines are seen
    bool chosen = true;                   // the output that is edited is bright: its frame and texts; others are dim
};

// In the projector's pixels, stored values, colours multiplied by alpha. Grid, Corners, Numbers,
// Focus and Identify hide the show: opaque. Otherwise it is transparent but for frame, handles,
// pointer and lines. Texts stand so that they are read on the wall whichever way the warp mirrors
// and turns the picture, and handles outside the picture are pointed at from its edge. Thread:
// reentrant.
RgbaImage drawEditView(const EditView& view);

// Light that is to pass the projector's colours, and so a picture for the renderer; opaque stored
// sRGB values, 0..255 the full range. Bars, after SMPTE EG 1: seven bars at 75 % (191) from grey to
// blue; below them, from 2/3 of the height, the same blues in reverse; below these, from 3/4, in
// place of the signals of NTSC: white, black, red, green and blue at 100 %, black, and strips of 2,
// 4 and 6 % (5, 10, 15). Ramp, four rows of equal height: 17 steps of 255 i / 16; all 256 values;
// 0..32; 223..255. The first, third and fourth bear their values.
RgbaImage drawColourCard(TestPicture picture, glm::ivec2 size);

}  // namespace fantascope::plot
