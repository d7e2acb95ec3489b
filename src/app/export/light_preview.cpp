#include "app/export/light_preview.h"

#include "core/check.h"
#include "core/parallel.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace fantascope::app {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kGamma = 2.2;
constexpr float kReflectance = 0.8f, kGroundReflectance = 0.6f;
constexpr double kWhite = 0.95;                         // the projector's full light on the mesh in the picture, linear
constexpr glm::dvec3 kBackground(0.004, 0.005, 0.008);  // linear
constexpr int kBand = 16;                               // rows that are processed together
// The bounding box's diagonal in the scene's space, metres: large enough that a millimetre is
// negligible.
constexpr double kDiagonal = 10;
constexpr glm::dvec3 kProjectorSide(-0.55, 0.6, 0.7), kViewerSide(0.4, 0.3, 1);
constexpr double kProjectorDistance = 3;  // in radii of the sphere around the box
constexpr double kRoom = 1.05;            // factor for a margin at the picture's edge

struct Bounds {
    glm::dvec3 low, high;

    glm::dvec3 middle() const { return (low + high) / 2.0; }
    double radius() const { return glm::distance(low, high) / 2; }
    std::array<glm::dvec3, 8> corners() const {
        std::array<glm::dvec3, 8> corners;
        for (std::size_t i = 0; i < corners.size(); ++i)
            corners[i] = {(i & 1 ? high : low).x, (i & 2 ? high : low).y, (i & 4 ? high : low).z};
        return corners;
    }
};

Bounds boundsOf(const TriangleMesh& mesh) {
    Bounds bounds{glm::dvec3(std::numeric_limits<double>::infinity()), glm::dvec3(-std::numeric_limits<double>::infinity())};
    for (const glm::uvec3& triangle : mesh.triangles)
        for (int corner = 0; corner < 3; ++corner) {
            const glm::dvec3 point = mesh.vertices[triangle[corner]];
            bounds.low = glm::min(bounds.low, point);
            bounds.high = glm::max(bounds.high, point);
        }
    return bounds;
}

// The place in the direction `side` of the box from which a picture just contains it. `half`: the
// picture's half width and height at distance 1.
glm::dvec3 standAt(const Bounds& bounds, glm::dvec3 side, glm::dvec2 half) {
    const glm::dvec3 towards = glm::normalize(side);
    const Pose pose = Pose::lookingAt(bounds.middle() + towards, bounds.middle()).value();
    double away = 0;
    for (const glm::dvec3& corner : bounds.corners()) {
        const glm::dvec3 local = pose.localFromWorld(corner);
        away = std::max({away, std::abs(local.x) / half.x - local.z, std::abs(local.y) / half.y - local.z});
    }
    return pose.position + towards * (kRoom * away);
}

// The throw ratio at which a picture of that aspect just contains the box; 0.5 if a part of the box
// lies behind.
double throwThatHolds(const Bounds& bounds, const Pose& pose, double aspect) {
    double half = 0;  // half width at distance 1
    for (const glm::dvec3& corner : bounds.corners()) {
        const glm::dvec3 local = pose.localFromWorld(corner);
        if (local.z <= 0) return 0.5;
        half = std::max({half, std::abs(local.x) / local.z, std::abs(local.y) / local.z * aspect});
    }
    return 1 / (2 * kRoom * half);
}

TriangleMesh floorUnder(const Bounds& bounds) {
    const double reach = 4 * bounds.radius();
    const auto at = [&](double x, double z) { return glm::vec3(bounds.middle().x + x, bounds.low.y, bounds.middle().z + z); };
    return {{at(-reach, -reach), at(-reach, reach), at(reach, reach), at(reach, -reach)}, {{0, 1, 2}, {0, 2, 3}}};
}

}  // namespace

struct LightPreview::Stage {
    site::Scene scene;
    vision::CameraModel projector, viewer;
    double lumens = 0;        // such that white makes pi lux on a surface that faces the projector there
    glm::dvec3 ambient{0.0};  // lux
    site::Lamp fromViewer;    // shows the shape of unlit parts
    double exposure = 1;      // linear light in the picture per cd/m2
    int finer = 1;            // camera pixels per pixel of the picture, each way
    bool keep = false;
    int threads = 1;
};

Result<LightPreview> LightPreview::create(TriangleMesh mesh, const PreviewPlaces& places, glm::ivec2 frameSize, glm::ivec2 size,
                                          Use use, int threads) {
    Bounds bounds = boundsOf(mesh);
    if (!(bounds.radius() > 0)) return Error("the mesh has no extent");
    // Scales the mesh to a fixed size, so that the file's unit does not matter.
    const double scale = kDiagonal / (2 * bounds.radius());
    for (glm::vec3& vertex : mesh.vertices) vertex = glm::dvec3(vertex) * scale;
    bounds = boundsOf(mesh);
    const auto scaled = [&](const std::optional<glm::dvec3>& place, glm::dvec3 otherwise) {
        return place ? *place * scale : otherwise;
    };

    const double frameAspect = double(frameSize.x) / frameSize.y, aspect = double(size.x) / size.y;
    const glm::dvec3 lookAt = scaled(places.lookAt, bounds.middle()), viewerLookAt = scaled(places.viewerLookAt, bounds.middle());
    const glm::dvec3 projectorAt =
        scaled(places.projector, bounds.middle() + glm::normalize(kProjectorSide) * (kProjectorDistance * bounds.radius()));
    const double half = std::tan(places.fieldOfView / 2);
    const glm::dvec3 viewerAt = scaled(places.viewer, standAt(bounds, kViewerSide, {half, half / aspect}));
    const Pose projectorPose = TRY(Pose::lookingAt(projectorAt, lookAt).in("the projector"));
    const Pose viewerPose = TRY(Pose::lookingAt(viewerAt, viewerLookAt).in("the viewer"));
    const double throwRatio = places.throwRatio.value_or(throwThatHolds(bounds, projectorPose, frameAspect));

    std::vector<site::SceneObject> objects = {{std::move(mesh), glm::vec3(kReflectance)}};
    if (places.ground) objects.push_back({floorUnder(bounds), glm::vec3(kGroundReflectance)});
    const auto projector = vision::CameraModel::fromThrowRatio(projectorPose, frameSize, throwRatio, {0, 0});
    const auto viewer = TRY(vision::CameraModel::fromFieldOfView(viewerPose, size, places.fieldOfView));
    const double reach = glm::distance(projectorAt, lookAt) / projector.focal;
    const double halfAmbient = kPi * places.ambient / 2;
    site::Lamp fromViewer;
    fromViewer.position = viewerAt;
    fromViewer.aim = glm::normalize(viewerLookAt - viewerAt);
    fromViewer.beam = radians(170);
    fromViewer.field = radians(178);
    fromViewer.candela = halfAmbient * std::pow(glm::distance(viewerAt, viewerLookAt), 2);
    auto stage = std::make_shared<const Stage>(
        Stage{site::Scene(objects), projector, viewer, kPi * frameSize.x * frameSize.y * reach * reach, glm::dvec3(halfAmbient),
              fromViewer, kWhite / (kReflectance * (1 + places.ambient)), use == Use::Still ? 2 : 1, use == Use::Film, threads});
    return LightPreview(std::move(stage), site::ProjectedLight(frameSize, kGamma, 0));
}

LightPreview::LightPreview(std::shared_ptr<const Stage> stage, site::ProjectedLight light) : stage_(std::move(stage)) {
    light_.push_back(std::move(light));
    views_.resize(static_cast<std::size_t>((stage_->viewer.size.y + kBand - 1) / kBand));
}

std::unique_ptr<site::CameraView> LightPreview::viewOf(int band) const {
    const int first = band * kBand, rows = std::min(kBand, stage_->viewer.size.y - first);
    vision::CameraModel camera = stage_->viewer;
    camera.size = glm::ivec2(camera.size.x, rows) * stage_->finer;
    camera.centre = (camera.centre - glm::dvec2(0, first)) * static_cast<double>(stage_->finer);
    camera.focal *= stage_->finer;
    auto view = std::make_unique<site::CameraView>(stage_->scene, camera, stage_->ambient, kBackground / stage_->exposure);
    view->addLamp(stage_->fromViewer);
    view->addProjector(stage_->projector, stage_->lumens);
    return view;
}

RgbaImage LightPreview::draw(std::shared_ptr<const RgbaImage> frame) {
    light_[0].show(std::move(frame));
    const glm::ivec2 size = stage_->viewer.size;
    const int finer = stage_->finer;
    RgbaImage picture(size.x, size.y);
    parallelFor(static_cast<int>(views_.size()), stage_->threads, [&](int band) {
        auto& view = views_[static_cast<std::size_t>(band)];
        if (!view) view = viewOf(band);
        const int first = band * kBand, rows = std::min(kBand, size.y - first);
        Image<glm::vec3> luminance(size.x * finer, rows * finer);
        const std::array full{glm::vec3(1)};
        view->render(full, light_, 0, luminance);
        if (!stage_->keep) view.reset();
        for (int y = 0; y < rows; ++y)
            for (int x = 0; x < size.x; ++x) {
                glm::vec3 sum(0);
                for (int i = 0; i < finer * finer; ++i) sum += luminance.at(x * finer + i % finer, y * finer + i / finer);
                const glm::vec3 light = sum * static_cast<float>(stage_->exposure / (finer * finer));
                const auto stored = [](float value) {
                    return static_cast<std::uint8_t>(std::lround(255 * srgbFromLinear(std::min(value, 1.0f))));
                };
                picture.at(x, first + y) = {stored(light.r), stored(light.g), stored(light.b), 255};
            }
    });
    return picture;
}

}  // namespace fantascope::app
