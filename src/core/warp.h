#pragma once

#include "core/geometry.h"
#include "core/result.h"

#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>

#include <array>
#include <optional>
#include <vector>

namespace fantascope {

// A rectangle of the canvas, in widths and heights of the canvas.
struct CanvasPart {
    glm::dvec2 low{0.0}, high{1.0};  // top left and bottom right
    friend bool operator==(const CanvasPart&, const CanvasPart&) = default;
};

// The orientation of a projector's picture: first mirrored, as for rear projection, then turned, as
// for a projector on its side.
struct Orientation {
    enum class Flip { None, Horizontal, Vertical };
    Flip flip = Flip::None;
    int quarterTurns = 0;  // clockwise, 0..3
    friend bool operator==(const Orientation&, const Orientation&) = default;
};

// A lattice of points, spread evenly over the picture, with offsets from the keystone alone.
struct WarpMesh {
    enum class Between {
        Smooth,   // bicubic Bezier patches through all points, with continuous slope (Catmull & Rom 1974)
        Straight  // bilinear: for dense, measured meshes
    };
    static constexpr int kMaxPoints = 129;  // across, and down

    Between between = Between::Smooth;
    glm::ivec2 points{0};             // across and down: 2 .. kMaxPoints each; 0: no mesh
    std::vector<glm::dvec2> offsets;  // projector pixels; row by row from the picture's top left

    // The offset of a point of the picture, 0..1 from its top left; beyond the picture as at its
    // edge.
    glm::dvec2 offsetAt(glm::dvec2 onPicture) const;
    // A mesh with another number of points, 0 or at least 2 each way, that lie where this mesh puts
    // them.
    WarpMesh resampled(glm::ivec2 count) const;
    friend bool operator==(const WarpMesh&, const WarpMesh&) = default;
};

// A warp as a technician sets it. The canvas's `part` is flipped and turned, its corners go to
// `corners`, and the mesh moves the points between.
struct WarpShape {
    CanvasPart part{};
    Orientation orientation{};
    std::array<glm::dvec2, 4> corners{};  // projector pixels: the picture's top left, top right, bottom right, bottom left
    WarpMesh mesh{};

    // The same on a projector with `factor` times as many pixels across and down.
    WarpShape scaled(glm::dvec2 factor) const;
    // The same after a map of the projector's pixels: every point of the mesh, and every corner, is
    // where `map` takes it. The map is nearly the identity.
    WarpShape moved(const Homography& map) const;
    friend bool operator==(const WarpShape&, const WarpShape&) = default;
};

// The map from a canvas to a projector's picture. Canvas points here are in widths and heights of
// the whole canvas, 0..1, whatever its aspect. Value type; constant.
class Warp {
public:
    // Error: corners that are no picture's, a part without area, a mesh that folds the picture, or
    // a mesh with inconsistent counts.
    static Result<Warp> of(const WarpShape& shape);
    // The whole canvas, from edge to edge of a picture of `size` pixels.
    static Warp straight(glm::ivec2 size);

    // The warp of a picture placed on the canvas, perhaps beyond its edges. In it the picture takes
    // the role of the canvas; what is shown may be a part of the picture or more than all of it.
    Warp ofPictureOn(const CanvasPart& place) const;

    const WarpShape& shape() const { return shape_; }
    // The visible part of the canvas: its part, limited to the canvas if the part exceeds its
    // edges.
    CanvasPart shown() const;
    bool bends() const { return shape_.mesh.points.x > 0; }
    // The map from the canvas by the keystone alone.
    const Homography& keystone() const { return keystone_; }
    // The map from the picture's own square, 0..1 from its top left, over which the mesh's points
    // are spread.
    const Homography& keystoneFromPicture() const { return keystoneFromPicture_; }
    const Homography& pictureFromCanvas() const { return pictureFromCanvas_; }

    glm::dvec2 offsetAt(glm::dvec2 onPicture) const { return shape_.mesh.offsetAt(onPicture); }
    // Beyond the canvas's part the plane continues up to its horizon.
    glm::dvec2 projectorFromCanvas(glm::dvec2 canvas) const;
    // Nothing beyond the keystone's horizon.
    std::optional<glm::dvec2> canvasFromProjector(glm::dvec2 pixel) const;
    // Whether any of the canvas's part is visible in a picture of `size` pixels.
    bool reaches(glm::ivec2 size) const;
    // The height of the whole canvas in pixels, averaged over the shown part. `aspect`: its width /
    // height.
    double canvasRows(double aspect) const;

private:
    Warp(const WarpShape& shape, const Homography& keystoneFromPicture, const glm::dmat3& pictureFromCanvas);
    glm::dvec2 projectorFromPicture(glm::dvec2 onPicture) const;
    // Columns: how a pixel moves per step right and down in the square.
    glm::dmat2 slopeAt(glm::dvec2 onPicture) const;
    bool folds() const;

    WarpShape shape_;
    Homography keystoneFromPicture_, pictureFromKeystone_, pictureFromCanvas_, canvasFromPicture_, keystone_;
};

}  // namespace fantascope
