#pragma once

#include "core/geometry.h"
#include "core/result.h"

#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>

#include <array>
#include <optional>
#include <vector>

namespace fantascope {

// A rectangle of the canvas, in widths and heights of it.
struct CanvasPart {
    glm::dvec2 low{0.0}, high{1.0};  // its top left and bottom right
    friend bool operator==(const CanvasPart&, const CanvasPart&) = default;
};

// Which way up a picture leaves the projector: first mirrored, as rear projection needs it, then
// turned, as a projector on its side does.
struct Orientation {
    enum class Flip { None, Horizontal, Vertical };
    Flip flip = Flip::None;
    int quarterTurns = 0;  // clockwise, 0..3
    friend bool operator==(const Orientation&, const Orientation&) = default;
};

// A lattice of points, spread evenly over the picture, that are moved from where the keystone alone
// puts them.
struct WarpMesh {
    enum class Between {
        Smooth,   // bicubic Bezier patches through all points, joined without a kink (Catmull & Rom 1974)
        Straight  // bilinear: for dense meshes that were measured
    };
    static constexpr int kMostPoints = 129;  // across, and down

    Between between = Between::Smooth;
    glm::ivec2 points{0};             // across and down: 2 .. kMostPoints each; 0: no mesh
    std::vector<glm::dvec2> offsets;  // projector pixels; row by row from the picture's top left

    // Where it moves a point of the picture, 0..1 from its top left; beyond the picture as at its
    // edge.
    glm::dvec2 offsetAt(glm::dvec2 onPicture) const;
    // One of another number of points, 0 or at least 2 each way, that lie where this one has them.
    WarpMesh resampled(glm::ivec2 count) const;
    friend bool operator==(const WarpMesh&, const WarpMesh&) = default;
};

// A warp as a technician sets it. The canvas's `part` is flipped and turned, its corners then go to
// `corners`, and what lies between them is moved by the mesh.
struct WarpShape {
    CanvasPart part{};
    Orientation orientation{};
    std::array<glm::dvec2, 4> corners{};  // projector pixels, of the picture's top left, top right, bottom right and bottom left
    WarpMesh mesh{};

    // The same on a projector that has `factor` times as many pixels across and down.
    WarpShape scaled(glm::dvec2 factor) const;
    friend bool operator==(const WarpShape&, const WarpShape&) = default;
};

// How a canvas lies in a projector's picture. Canvas points are widths and heights of the whole
// canvas here, 0..1, whatever its aspect. Value type; constant.
class Warp {
public:
    // Error: corners that are not those of a picture, a part without an area, a mesh that folds the
    // picture or whose numbers do not fit.
    static Result<Warp> of(const WarpShape& shape);
    // The whole canvas, from edge to edge of a picture of `size` pixels.
    static Warp straight(glm::ivec2 size);

    // The same for a picture that lies on a part of the canvas, perhaps beyond its edges: the
    // picture is then the canvas, and what is shown of it may end before, or lie around, its edges.
    Warp ofPictureOn(const CanvasPart& place) const;

    const WarpShape& shape() const { return shape_; }
    // What is seen of the canvas: its part, which of a picture on it may reach over the edges.
    CanvasPart shown() const;
    bool bends() const { return shape_.mesh.points.x > 0; }
    // The canvas by the keystone alone.
    const Homography& keystone() const { return keystone_; }
    // The picture's own square, 0..1 from its top left, in which the mesh's points are spread.
    const Homography& keystoneFromPicture() const { return keystoneFromPicture_; }
    const Homography& pictureFromCanvas() const { return pictureFromCanvas_; }

    glm::dvec2 offsetAt(glm::dvec2 onPicture) const { return shape_.mesh.offsetAt(onPicture); }
    // Beyond the canvas's part the plane goes on, up to its horizon.
    glm::dvec2 projectorFromCanvas(glm::dvec2 canvas) const;
    // Nothing beyond the horizon of the keystone.
    std::optional<glm::dvec2> canvasFromProjector(glm::dvec2 pixel) const;
    // Whether anything of the canvas's part is seen in a picture of `size` pixels.
    bool reaches(glm::ivec2 size) const;
    // How many pixels the whole canvas would be high, on average over the part that is shown.
    // `aspect`: its width / height.
    double canvasRows(double aspect) const;

private:
    Warp(const WarpShape& shape, const Homography& keystoneFromPicture, const glm::dmat3& pictureFromCanvas);
    glm::dvec2 projectorFromPicture(glm::dvec2 onPicture) const;
    // Columns: the move of a pixel for one step right and one down in the square.
    glm::dmat2 slopeAt(glm::dvec2 onPicture) const;
    bool folds() const;

    WarpShape shape_;
    Homography keystoneFromPicture_, pictureFromKeystone_, pictureFromCanvas_, canvasFromPicture_, keystone_;
};

}  // namespace fantascope
