#pragma once

#include "drivers/site/camera_view.h"
#include "drivers/site/projected_light.h"
#include "drivers/site/scene.h"

#include "vision/camera_model.h"

#include "core/result.h"
#include "media/image.h"
#include "media/mesh.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <memory>
#include <optional>
#include <vector>

namespace fantascope::app {

// Where projector and viewer stand around a mesh, in the mesh's own unit; what is absent follows
// from the mesh's bounding box.
struct PreviewPlaces {
    std::optional<glm::dvec3> projector;  // default: before it, from the upper left
    std::optional<glm::dvec3> lookAt;     // of the projector; default: the middle
    std::optional<double> throwRatio;     // distance / picture width; default: its picture just holds all of the mesh
    std::optional<glm::dvec3> viewer;  // default: before it, from a little to the right and above, so far that all of it is seen
    std::optional<glm::dvec3> viewerLookAt;  // default: the middle
    double fieldOfView = radians(35);        // across the viewer's picture, 0 < fieldOfView < pi
    bool ground = false;                     // lay a floor under it
    double ambient = 0.06;                   // light from everywhere and from the viewer, as a share of the projector's white
};

// A mesh in a projector's light, seen from somewhere (Ji et al. 2015, Figures 7d and 9): a site
// with one projector and no other lamp. Every surface is matt and grey; what the projector does not
// see stays in the ambient light. The projector's gamma is 2.2, and its white on a surface that
// faces it at the distance of `lookAt` is just below full white. Thread-bound.
class LightPreview {
public:
    // How often it is drawn. A still has 16 samples a pixel and keeps nothing; a film has 4 and
    // keeps them, some 350 bytes a pixel.
    enum class Use { Still, Film };

    // `frameSize`: of the frames that will be projected, at least 2 each way; `size`: of the
    // picture. y is up. Error: a place that is what it looks at, or straight above it; a mesh
    // without extent.
    static Result<LightPreview> create(TriangleMesh mesh, const PreviewPlaces& places, glm::ivec2 frameSize, glm::ivec2 size,
                                       Use use, int threads);

    // `frame`: stored values, as sent to a projector. The picture does not depend on the number of
    // threads.
    RgbaImage draw(std::shared_ptr<const RgbaImage> frame);

private:
    struct Stage;
    explicit LightPreview(std::shared_ptr<const Stage> stage, site::ProjectedLight light);
    std::unique_ptr<site::CameraView> viewOf(int band) const;

    std::shared_ptr<const Stage> stage_;
    std::vector<site::ProjectedLight> light_;               // one
    std::vector<std::unique_ptr<site::CameraView>> views_;  // of each band of rows, once it is needed
};

}  // namespace fantascope::app
