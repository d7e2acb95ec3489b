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

// The places of projector and viewer around a mesh, in the mesh's unit. Absent ones follow from the
// mesh's bounding box.
struct PreviewPlaces {
    std::optional<glm::dvec3> projector;  // default: in front, upper left
    std::optional<glm::dvec3> lookAt;     // where the projector looks; default: the box's middle
    std::optional<double> throwRatio;     // distance / picture width; default: the picture just contains the mesh
    std::optional<glm::dvec3> viewer;     // default: in front, a little to the right and above, far enough to see the whole mesh
    std::optional<glm::dvec3> viewerLookAt;  // default: the box's middle
    double fieldOfView = radians(35);        // horizontal, of the viewer, 0 < fieldOfView < pi
    bool ground = false;                     // add a floor under the mesh
    double ambient = 0.06;  // other light, from all sides and from the viewer, as a share of the projector's white
};

// A mesh in a projector's light, seen by a viewer (Ji et al. 2015, Figures 7d and 9): a site with
// one projector and no other lamp. Every surface is matt and grey; parts that the projector does
// not reach get only ambient light. The projector's gamma is 2.2. Its white, on a surface that
// faces it at the distance of `lookAt`, is just below full white. Thread: thread-bound.
class LightPreview {
public:
    // A still has 16 samples per pixel and keeps nothing. A film has 4 and keeps them between
    // frames, some 350 bytes per pixel.
    enum class Use { Still, Film };

    // `mesh`: y up. `frameSize`: of the projected frames, pixels, at least 2 each way. `size`: of
    // the picture, pixels. Error: projector or viewer is where it looks or straight above that, or
    // the mesh has no extent.
    static Result<LightPreview> create(TriangleMesh mesh, const PreviewPlaces& places, glm::ivec2 frameSize, glm::ivec2 size,
                                       Use use, int threads);

    // Returns what the viewer sees. `frame`: stored values, as sent to a projector. The picture
    // does not depend on the number of threads.
    RgbaImage draw(std::shared_ptr<const RgbaImage> frame);

private:
    struct Stage;
    explicit LightPreview(std::shared_ptr<const Stage> stage, site::ProjectedLight light);
    std::unique_ptr<site::CameraView> viewOf(int band) const;

    std::shared_ptr<const Stage> stage_;
    std::vector<site::ProjectedLight> light_;               // exactly one
    std::vector<std::unique_ptr<site::CameraView>> views_;  // per band of rows, made when needed
};

}  // namespace fantascope::app
