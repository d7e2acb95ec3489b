#pragma once
// The pictures that a technician sees on a projector while setting it up.

#include "media/image.h"
#include "media/projection.h"

#include <glm/vec2.hpp>

#include <optional>
#include <string>
#include <vector>

namespace fantascope::plot {

// The state of one output while it is edited. Texts are UTF-8.
struct EditView {
    // A point that can be moved.
    struct Handle {
        glm::dvec2 at{0.0};  // projector pixels
        std::string label{};
        bool chosen = false;
    };

    const Projection& projection;  // only its size, warp and masks are used
    double aspect = 16.0 / 9;      // of the whole canvas, width / height: outputs that share a canvas share a grid
    std::string name{};            // of the output
    int number = 1;
    TestPicture picture = TestPicture::None;
    std::vector<Handle> handles{};
    std::optional<glm::dvec2> pointer{};  // mouse pointer, projector pixels
    std::vector<std::string> lines{};     // say what is being edited; the first is the headline
    bool masks = false;                   // whether their outlines are drawn
    bool chosen = true;                   // this output is being edited: its frame and texts are bright, those of others dim
};

// In the projector's pixels, stored values, colours multiplied by alpha. Grid, Corners, Numbers,
// Focus and Identify are opaque and hide the show. Otherwise the picture is transparent, except for
// frame, handles, pointer and lines. Texts are upright on the wall even if the warp mirrors and
// rotates the picture. Arrows at the edge point to handles outside the picture. Thread: reentrant.
RgbaImage drawEditView(const EditView& view);

// Bars or Ramp: pictures for the renderer, since they must pass the projector's colours. Opaque
// stored sRGB values, full range 0..255. Bars, after SMPTE EG 1: seven bars at 75 % (191) from grey
// to blue; below them, from 2/3 of the height, the same blues in reverse; below these, from 3/4,
// instead of the NTSC signals, white, black, red, green and blue at 100 %, black, and strips of 2,
// 4 and 6 % (5, 10, 15).
// Ramp: four rows of equal height: 17 steps of 255 i / 16; all 256 values; 0..32; 223..255. The
// first, third and fourth are labelled with their values.
RgbaImage drawColourCard(TestPicture picture, glm::ivec2 size);

}  // namespace fantascope::plot
