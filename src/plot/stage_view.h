#pragma once

#include "theatre/mask/bit_mask.h"
#include "theatre/stage/stage.h"

#include "media/image.h"
#include "media/mesh.h"
#include "plot/rendering.h"

#include <glm/vec3.hpp>

#include <vector>

namespace fantascope::plot {

// An outside view of a shadow theatre's stage: each lamp and its beam to the target, the actors on
// the floor, and behind them the screens with their shadows and the targets' outlines in red.
// Metres, the stage's frame.
struct StageView {
    struct Actor {
        TriangleMesh mesh;
        glm::dvec3 colour{0.5};  // sRGB, 0..1
    };

    theatre::Stage stage;
    // A beam's image on its screen, unrolled if that is curved.
    struct Image {
        theatre::ScreenFrame frame;
        theatre::BitMask shadow, target;  // both of the frame's size
    };
    std::vector<Image> images;  // one per beam
    std::vector<Actor> actors;
    std::vector<Actor> props{};  // platforms and props

    // Cameras for a picture of this aspect. overview(): from behind the first lamp, from above and
    // the right, or from the left if that shows more screens from the front. closeUp(): the same
    // direction, but near, without the lamps. fromTheSide(): everything, from the right.
    Camera overview(double aspect) const;
    Camera closeUp(double aspect) const;
    Camera fromTheSide(double aspect) const;

    // The picture is opaque. The floor has a grid of 1 m and is darker close below things. Thread:
    // reentrant.
    RgbaImage draw(const Camera& camera, int width, int height) const;
};

}  // namespace fantascope::plot
