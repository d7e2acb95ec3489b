#pragma once

#include "theatre/mask/bit_mask.h"
#include "theatre/stage/stage.h"

#include "media/image.h"
#include "media/mesh.h"
#include "plot/rendering.h"

#include <glm/vec3.hpp>

#include <vector>

namespace fantascope::plot {

// What an outsider would see on the stage of a shadow theatre: each lamp and its beam to the
// target, the actors on the floor, and behind them the screens with their shadows and the targets'
// outlines in red. Metres, the stage's frame.
struct StageView {
    struct Actor {
        TriangleMesh mesh;
        glm::dvec3 colour{0.5};  // sRGB, 0..1
    };

    theatre::Stage stage;
    // What is on a beam's screen, as it looks there: unrolled.
    struct Image {
        theatre::ScreenFrame frame;
        theatre::BitMask shadow, target;  // both of the frame's size
    };
    std::vector<Image> images;  // of each beam
    std::vector<Actor> actors;
    std::vector<Actor> props{};  // platforms and whatever else stands there

    // Cameras for a picture of this aspect: from behind the first lamp, from above and the right,
    // or the left if that shows more screens from before; the same, near, with people and screens,
    // but not the lamps; and from the right, with all.
    Camera overview(double aspect) const;
    Camera closeUp(double aspect) const;
    Camera fromTheSide(double aspect) const;

    // Opaque. The floor has a line a metre and is darker where something stands close above it.
    // Thread: reentrant.
    RgbaImage draw(const Camera& camera, int width, int height) const;
};

}  // namespace fantascope::plot
